#include "host/exchange/number_text.hpp"

#include <array>
#include <charconv>

namespace raysteer::host::exchange {

std::string exact(double value) {
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  std::string number(text.data(), end);
  if (number.find_first_of(".einf") == std::string::npos) {
    number += ".0";  // else TOML and YAML take it for a whole number, and -0 loses its sign
  }
  return number;
}

}  // namespace raysteer::host::exchange
