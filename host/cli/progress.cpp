#include "host/cli/progress.hpp"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace raysteer::host::cli {
namespace {

using std::chrono::duration;
using std::chrono::nanoseconds;

// Ten times a second is as often as an eye follows, and costs a solver nothing.
constexpr nanoseconds kRedraw = std::chrono::milliseconds(100);
// Before this much is done an estimate jumps about.
constexpr double kEnoughToEstimate = 0.02;

int columns_of(int terminal) {
  winsize size{};
  return ::ioctl(terminal, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string remaining(double seconds) {
  if (seconds < 90) {
    return fmt::format("about {:.0f} s left", std::max(1.0, std::ceil(seconds)));
  }
  return fmt::format("about {:.0f} min left", std::ceil(seconds / 60));
}

void write_all(int file, const std::string& text) {
  // A terminal that went away is no reason to fail.
  (void)!::write(file, text.data(), text.size());
}

}  // namespace

std::string progress_line(const std::string& stage, double done, double left_s, int columns) {
  const std::string numbers = fmt::format("{:3.0f} %", std::floor(100 * std::clamp(done, 0.0, 1.0)));
  std::string line = stage + " " + numbers;
  if (left_s >= 0) {
    const std::string longer = line + ", " + remaining(left_s);
    if (static_cast<int>(longer.size()) < columns) {
      line = longer;
    }
  }
  const int room = columns - 1;  // a full last column makes some terminals wrap
  if (static_cast<int>(line.size()) > room) {
    const int for_stage = std::max(0, room - static_cast<int>(numbers.size()) - 1);
    line = stage.substr(0, static_cast<std::size_t>(for_stage)) + " " + numbers;
  }
  return line;
}

Progress::Progress(int terminal, Now now) : terminal_(terminal), now_(std::move(now)) {}

Progress::~Progress() { clear(); }

void Progress::start(std::string stage) {
  const std::lock_guard lock(mutex_);
  stage_ = std::move(stage);
  if (terminal_ >= 0) {
    started_ = now_();
    draw(0, started_);
  }
}

void Progress::at(const std::string& stage, double done) {
  const std::lock_guard lock(mutex_);
  if (terminal_ < 0 || stage != stage_) {
    return;
  }
  const nanoseconds now = now_();
  if (!visible_ || now - drawn_ >= kRedraw) {
    draw(done, now);
  }
}

void Progress::clear() {
  const std::lock_guard lock(mutex_);
  if (visible_) {
    write_all(terminal_, "\r\033[K");
    visible_ = false;
  }
}

void Progress::draw(double done, nanoseconds now) {
  const double elapsed_s = duration<double>(now - started_).count();
  const double left_s = done >= kEnoughToEstimate ? elapsed_s * (1 - done) / done : -1;
  write_all(terminal_, "\r" + progress_line(stage_, done, left_s, columns_of(terminal_)) + "\033[K");
  drawn_ = now;
  visible_ = true;
}

}  // namespace raysteer::host::cli
