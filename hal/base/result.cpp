#include "hal/base/result.hpp"

#include <cstdio>

namespace raysteer {

std::string Error::message() const {
  std::string text(explain(rcode).sentence);
  if (!note.empty()) {
    text += ": ";
    text += note;
  }
  return text;
}

Error fail(RCode rcode, std::string note, std::int64_t detail, const char* file, int line) {
  return Error{rcode, detail, std::move(note), file, line};
}

Error with_context(Error error, std::string_view context) {
  std::string note(context);
  if (!error.note.empty()) {
    note += ": ";
    note += error.note;
  }
  error.note = std::move(note);
  return error;
}

void check_failed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "raysteer: internal error: %s does not hold at %s:%d\n", condition, file, line);
  std::abort();
}

}  // namespace raysteer
