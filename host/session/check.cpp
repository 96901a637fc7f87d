#include "host/session/check.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>
#include <utility>

#include "host/session/lit_part.hpp"

namespace raysteer::host::session {
namespace {

using calib::decode::SequenceCheck;
using calib::decode::SequenceReport;

// Decoding a frame is what takes the time; more threads than this wait for the disk.
constexpr std::size_t kThreads = 2;

// Every frame of one look of one camera, through a check. Frames that cannot be read end it.
Result<SequenceReport> read_look(const Session& session, int camera, int look, const std::function<bool()>& on_frame) {
  const Result<Region> lit = lit_part(session, camera, look);
  if (!lit) {
    return lit.error();
  }
  SequenceCheck check(session.manifest().sequence, *lit, session.bits(camera));
  Image<std::uint8_t> narrow;
  Image<std::uint16_t> wide;
  for (int index = 0; index < session.frames_per_look(); ++index) {
    const FrameId id{camera, look, index};
    if (session.bits(camera) == 8) {
      RAYSTEER_TRY(session.load(id, narrow));
      check.add(index, std::as_const(narrow).view());
    } else {
      RAYSTEER_TRY(session.load(id, wide));
      check.add(index, std::as_const(wide).view());
    }
    if (!on_frame()) {
      return fail(RCode::kCancelled);
    }
  }
  return check.report();
}

std::string place(const Session& session, int camera, int look) {
  return "camera '" + session.manifest().cameras[static_cast<std::size_t>(camera)].name + "', look '" +
         session.manifest().looks[static_cast<std::size_t>(look)].name + "'";
}

}  // namespace

CheckReport check_session(const Session& session, const Progress& progress) {
  struct Job {
    int camera;
    int look;
    Result<SequenceReport> result = SequenceReport{};
  };
  std::vector<Job> jobs;
  for (int look = 0; look < session.looks(); ++look) {
    for (int camera = 0; camera < session.cameras(); ++camera) {
      jobs.push_back({camera, look});
    }
  }
  const int total = static_cast<int>(jobs.size()) * session.frames_per_look();
  int done = 0;
  std::mutex one_at_a_time;
  bool stopped = false;
  const auto on_frame = [&] {
    const std::lock_guard lock(one_at_a_time);
    ++done;
    stopped = stopped || (progress && !progress(done, total));
    return !stopped;
  };
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t n = next++; n < jobs.size(); n = next++) {
      jobs[n].result = read_look(session, jobs[n].camera, jobs[n].look, on_frame);
    }
  };
  {
    std::vector<std::jthread> threads;
    for (std::size_t n = 1; n < std::min(kThreads, jobs.size()); ++n) {
      threads.emplace_back(work);
    }
    work();
  }

  CheckReport report;
  report.frames = done;
  for (Job& job : jobs) {
    const std::string where = place(session, job.camera, job.look);
    if (!job.result) {
      report.faults.push_back(std::move(job.result).error());
      continue;
    }
    for (const Error& error : job.result->faults) {
      report.faults.push_back(with_context(error, where));
    }
    for (const Error& error : job.result->warnings) {
      report.warnings.push_back(with_context(error, where));
    }
    report.looks.push_back({session.manifest().cameras[static_cast<std::size_t>(job.camera)].name,
                            session.manifest().looks[static_cast<std::size_t>(job.look)].name, std::move(*job.result)});
  }
  return report;
}

Status check_look(const Session& session, int camera, int look) {
  Result<SequenceReport> report = read_look(session, camera, look, [] { return true; });
  if (!report) {
    return std::move(report).error();
  }
  if (!report->good()) {
    return with_context(report->faults.front(), place(session, camera, look));
  }
  return ok();
}

}  // namespace raysteer::host::session
