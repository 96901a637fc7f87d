// pure: "did you mean": the known word nearest to a misspelt one.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace raysteer {

/// Edits (insert, delete, replace, swap of neighbours) that turn `a` into `b`: optimal string alignment distance.
int edit_distance(std::string_view a, std::string_view b);

/// The known word nearest to `word`, or an empty view when none is near enough (a third of its length, at least two
/// edits) to be worth suggesting.
std::string_view nearest(std::string_view word, std::span<const std::string_view> known);

/// "; did you mean 'check'?", or nothing.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> known);

}  // namespace raysteer
