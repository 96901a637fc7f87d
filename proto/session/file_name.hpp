// value: file-name templates: "left/{look}_{index:02}.png".
#pragma once

#include <string>
#include <string_view>

#include "hal/base/result.hpp"

namespace raysteer::proto::session {

struct TemplateUse {
  bool camera = false;
  bool look = false;
  bool index = false;
};

/// What a template stands for, or what is wrong with it in words ("has '{indx}'; known are ...").
Result<TemplateUse> check_template(std::string_view text);

/// Fills a template that check_template() accepts.
std::string fill_template(std::string_view text, std::string_view camera, std::string_view look, int index);

}  // namespace raysteer::proto::session
