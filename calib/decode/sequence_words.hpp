// value: numbers and lists as the notes of the sequence check say them. Private to the sequence check.
#pragma once

#include <string>
#include <vector>

namespace raysteer::calib::decode {

/// 0.125: "12.5 %"
std::string percent(double share);
/// With two decimals; not negative.
std::string fixed(double value);
/// "frame 3", "frames 3, 4"; of long lists the first and how many more.
std::string list_of(const std::vector<int>& frames);

}  // namespace raysteer::calib::decode
