// pure: numbers as text that reads back to the same bits.
#pragma once

#include <string>

namespace raysteer::host::exchange {

/// The shortest decimal that reads back exactly, always with a point or an exponent: "0.1", "800.0", "1e-07".
std::string exact(double value);

}  // namespace raysteer::host::exchange
