// value: the few numbers people look for first, as boxes at the top of a page. Those not known are left out.
#pragma once

#include <string>
#include <string_view>

namespace raysteer::host::report {

class Numbers {
 public:
  void add(double value, std::string_view unit, std::string_view meaning);
  void add(const std::string& value, std::string_view meaning);
  std::string take() const;

 private:
  std::string items_;
};

}  // namespace raysteer::host::report
