#include "proto/session/file_name.hpp"

#include "proto/session/manifest.hpp"

namespace raysteer::proto::session {
namespace {

struct Field {
  enum class Kind { kCamera, kLook, kIndex } kind = Kind::kIndex;
  int digits = 0;
};

std::optional<Field> parse_field(std::string_view inside) {
  if (inside == "camera") {
    return Field{Field::Kind::kCamera};
  }
  if (inside == "look") {
    return Field{Field::Kind::kLook};
  }
  if (inside == "index") {
    return Field{Field::Kind::kIndex};
  }
  if (inside.size() == 8 && inside.starts_with("index:0") && inside[7] >= '1' && inside[7] <= '9') {
    return Field{Field::Kind::kIndex, inside[7] - '0'};
  }
  return std::nullopt;
}

// Calls `literal` and `field` for the parts of a template; the text of a field that is none, if there is one.
template <class Literal, class OnField>
std::optional<std::string> walk(std::string_view text, Literal literal, OnField field) {
  while (!text.empty()) {
    const std::size_t open = text.find_first_of("{}");
    literal(text.substr(0, open));
    if (open == std::string_view::npos) {
      break;
    }
    const std::size_t close = text.find('}', open);
    const std::string_view whole = text.substr(open, close == std::string_view::npos ? close : close - open + 1);
    const bool closed = whole.size() >= 2 && whole.front() == '{';
    const std::optional<Field> parsed = closed ? parse_field(whole.substr(1, whole.size() - 2)) : std::nullopt;
    if (!parsed) {
      return std::string(whole);
    }
    field(*parsed);
    text.remove_prefix(close + 1);
  }
  return std::nullopt;
}

}  // namespace

Result<TemplateUse> check_template(std::string_view text) {
  TemplateUse use;
  const auto bad = walk(
      text, [](std::string_view) {},
      [&](const Field& field) {
        (field.kind == Field::Kind::kCamera ? use.camera
         : field.kind == Field::Kind::kLook ? use.look
                                            : use.index) = true;
      });
  if (bad) {
    return fail(RCode::kBadValue,
                "has '" + *bad + "'; known are {camera} {look} {index} and {index:02} for two digits");
  }
  return use;
}

std::string fill_template(std::string_view text, std::string_view camera, std::string_view look, int index) {
  std::string name;
  walk(
      text, [&](std::string_view literal) { name += literal; },
      [&](const Field& field) {
        if (field.kind == Field::Kind::kCamera) {
          name += camera;
        } else if (field.kind == Field::Kind::kLook) {
          name += look;
        } else {
          const std::string digits = std::to_string(index);
          const auto wanted = static_cast<std::size_t>(field.digits);
          name.append(wanted > digits.size() ? wanted - digits.size() : 0, '0');
          name += digits;
        }
      });
  return name;
}

std::string file_name(const Manifest& manifest, const Camera& camera, const Look& look, int index) {
  const std::string folder = manifest.frames.empty() ? "" : manifest.frames + "/";
  return folder + fill_template(camera.files, camera.name, look.name, camera.first_index + index);
}

}  // namespace raysteer::proto::session
