#include "host/report/numbers.hpp"

#include <fmt/core.h>

#include <cmath>

#include "host/report/html.hpp"
#include "host/report/svg.hpp"

namespace raysteer::host::report {

void Numbers::add(double value, std::string_view unit, std::string_view meaning) {
  if (std::isfinite(value)) {
    add(fmt::format("{} {}", brief(value), unit), meaning);
  }
}

void Numbers::add(const std::string& value, std::string_view meaning) {
  items_ += fmt::format("<li><b>{}</b><span>{}</span></li>\n", escape(value), escape(meaning));
}

std::string Numbers::take() const { return "<ul class=\"numbers\">\n" + items_ + "</ul>\n"; }

}  // namespace raysteer::host::report
