// shared: one line of progress on a terminal; nothing in a pipe.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

namespace raysteer::host::cli {

/// "finding boards  42 %, about 3 s left", at most `columns` wide: shortened, never wrapped. No estimate
/// (`left_s` < 0) shows none.
std::string progress_line(const std::string& stage, double done, double left_s, int columns);

class Progress {
 public:
  using Now = std::function<std::chrono::nanoseconds()>;

  /// `terminal` is a file descriptor to draw on, or -1 to draw nothing. `now` is any clock that only rises.
  Progress(int terminal, Now now);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void start(std::string stage);
  /// Ignored when `stage` is not the one running (a late worker thread).
  void at(const std::string& stage, double done);
  /// Removes the line, so that other text can be written. The next at() draws it again.
  void clear();

 private:
  void draw(double done, std::chrono::nanoseconds now);

  std::mutex mutex_;
  int terminal_;
  Now now_;
  std::string stage_;
  std::chrono::nanoseconds started_{0};
  std::chrono::nanoseconds drawn_{0};
  bool visible_ = false;
};

}  // namespace raysteer::host::cli
