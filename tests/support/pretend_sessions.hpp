// Small rendered sessions for tests: drawn once for each build of the tests, copied by each test that spoils them.
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "calib/synth/stage.hpp"
#include "host/pretend/rendered_session.hpp"
#include "tests/support/paths.hpp"

namespace raysteer::support {

inline constexpr std::uint64_t kPretendSeed = 3;

/// Cameras of 320x256, a panel of 320x200.
inline calib::synth::PretendRig small_pretend_rig() { return calib::synth::pretend_rig(kPretendSeed, 0.5); }

inline void render(const calib::synth::Stage& stage, const std::filesystem::path& folder) {
  const Status written = host::pretend::write_session(stage, small_pretend_rig().rig(), kPretendSeed, folder);
  if (!written) {
    throw std::runtime_error(written.error().message());
  }
}

/// The folder of a session that `make` draws, kept in the build tree until the test program is built anew. Tests run
/// as many processes at once: one draws, the others wait for it.
template <class Make>
std::filesystem::path rendered_once(const std::string& name, const Make& make) {
  namespace fs = std::filesystem;
  const fs::path program = fs::read_symlink("/proc/self/exe");
  const fs::path folder = program.parent_path().parent_path() / "pretend-sessions" / name;
  fs::create_directories(folder.parent_path());
  const int lock = ::open((folder.string() + ".lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  ::flock(lock, LOCK_EX);
  const std::string stamp = std::to_string(fs::last_write_time(program).time_since_epoch().count());
  std::ifstream in(folder / "stamp");
  const std::string found((std::istreambuf_iterator<char>(in)), {});
  if (found != stamp) {
    fs::remove_all(folder);
    render(make(), folder);
    std::ofstream(folder / "stamp") << stamp;
  }
  ::close(lock);
  return folder;
}

}  // namespace raysteer::support
