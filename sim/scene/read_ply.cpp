#include <bit>
#include <charconv>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/mesh_check.hpp"
#include "sim/scene/read_scene.hpp"

namespace raysteer::sim::scene {
namespace {

static_assert(std::endian::native == std::endian::little, "binary PLY is read as it stands in memory");

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

std::optional<Type> type_named(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, Type>, 16> kNames{{{"char", Type::kInt8},
                                                                      {"int8", Type::kInt8},
                                                                      {"uchar", Type::kUint8},
                                                                      {"uint8", Type::kUint8},
                                                                      {"short", Type::kInt16},
                                                                      {"int16", Type::kInt16},
                                                                      {"ushort", Type::kUint16},
                                                                      {"uint16", Type::kUint16},
                                                                      {"int", Type::kInt32},
                                                                      {"int32", Type::kInt32},
                                                                      {"uint", Type::kUint32},
                                                                      {"uint32", Type::kUint32},
                                                                      {"float", Type::kFloat},
                                                                      {"float32", Type::kFloat},
                                                                      {"double", Type::kDouble},
                                                                      {"float64", Type::kDouble}}};
  for (const auto& [known, type] : kNames) {
    if (name == known) {
      return type;
    }
  }
  return {};
}

struct Property {
  std::string name;
  Type type = Type::kFloat;
  std::optional<Type> count;  // of a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

// The file's bytes, taken one value after the other.
class Source {
 public:
  explicit Source(std::string_view bytes) : rest_(bytes) {}

  std::optional<std::string_view> line() {
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos) {
      return {};
    }
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    if (line.ends_with('\r')) {
      line.remove_suffix(1);
    }
    return line;
  }
  std::string_view word() {
    constexpr std::string_view kSpace = " \t\r\n";
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kSpace), rest_.size()));
    const std::string_view word = rest_.substr(0, rest_.find_first_of(kSpace));
    rest_.remove_prefix(word.size());
    return word;
  }
  std::optional<double> value(Type type, bool ascii) {
    if (ascii) {
      const std::string_view text = word();
      double number = 0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
      return error == std::errc{} && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
    }
    switch (type) {
      case Type::kInt8:
        return take<std::int8_t>();
      case Type::kUint8:
        return take<std::uint8_t>();
      case Type::kInt16:
        return take<std::int16_t>();
      case Type::kUint16:
        return take<std::uint16_t>();
      case Type::kInt32:
        return take<std::int32_t>();
      case Type::kUint32:
        return take<std::uint32_t>();
      case Type::kFloat:
        return take<float>();
      case Type::kDouble:
        return take<double>();
    }
    return {};
  }
  std::size_t left() const { return rest_.size(); }

 private:
  template <class Raw>
  std::optional<double> take() {
    if (rest_.size() < sizeof(Raw)) {
      return {};
    }
    Raw raw;
    std::memcpy(&raw, rest_.data(), sizeof raw);
    rest_.remove_prefix(sizeof raw);
    return static_cast<double>(raw);
  }
  std::string_view rest_;
};

class PlyReader {
 public:
  PlyReader(std::string_view bytes, std::string file) : source_(bytes), file_(std::move(file)) {}

  Result<Mesh> read() {
    RAYSTEER_TRY(read_header());
    for (const Element& element : elements_) {
      for (std::size_t i = 0; i < element.count; ++i) {
        RAYSTEER_TRY(read_one(element, i));
      }
    }
    if (!has_uv_) {
      mesh_.uv.clear();
    }
    RAYSTEER_TRY(check_mesh(mesh_, file_));
    return std::move(mesh_);
  }

 private:
  Error wrong(const std::string& note) const { return fail(RCode::kMeshSyntax, file_ + ": " + note); }

  Status read_header() {
    if (source_.line() != "ply") {
      return wrong("expected 'ply' in the first line");
    }
    bool has_format = false;
    for (auto line = source_.line(); line; line = source_.line()) {
      Source words(*line);
      const std::string_view key = words.word();
      if (key == "end_header") {
        return has_format ? ok() : Status(wrong("the header has no format"));
      }
      if (key == "format") {
        const std::string_view format = words.word();
        ascii_ = format == "ascii";
        if (!ascii_ && format != "binary_little_endian") {
          return wrong("expected format ascii or binary_little_endian, got '" + std::string(format) + "'");
        }
        has_format = true;
      } else if (key == "element") {
        RAYSTEER_TRY(read_element(words));
      } else if (key == "property") {
        RAYSTEER_TRY(read_property(words));
      } else if (key != "comment" && key != "obj_info") {
        return wrong("expected a header line, got '" + std::string(line->substr(0, 40)) + "'");
      }
    }
    return wrong("the header has no end");
  }

  Status read_element(Source& words) {
    Element element{.name = std::string(words.word()), .count = 0, .properties = {}};
    const auto count = words.value(Type::kUint32, true);
    // Each takes a byte at least: a larger count is a lie that would only keep us busy.
    if (!count || !(*count >= 0) || *count > static_cast<double>(source_.left())) {
      return wrong("element '" + element.name + "' claims more than the file holds");
    }
    element.count = static_cast<std::size_t>(*count);
    elements_.push_back(std::move(element));
    return ok();
  }

  Status read_property(Source& words) {
    if (elements_.empty()) {
      return wrong("a property before any element");
    }
    Property property;
    std::string_view type = words.word();
    if (type == "list") {
      property.count = type_named(words.word());
      if (!property.count) {
        return wrong("expected the type of a list's count");
      }
      type = words.word();
    }
    const auto known = type_named(type);
    if (!known) {
      return wrong("expected a type, got '" + std::string(type) + "'");
    }
    property.type = *known;
    property.name = std::string(words.word());
    elements_.back().properties.push_back(std::move(property));
    return ok();
  }

  Status read_one(const Element& element, std::size_t index) {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Vector2d uv = Eigen::Vector2d::Zero();
    const auto short_of = [&] {
      return wrong("element '" + element.name + "' " + std::to_string(index + 1) + " of " +
                   std::to_string(element.count) + " is cut short or no number");
    };
    for (const Property& property : element.properties) {
      if (property.count) {
        const auto count = source_.value(*property.count, ascii_);
        if (!count || !(*count >= 0) || *count > static_cast<double>(source_.left())) {
          return short_of();
        }
        std::vector<std::uint32_t> corners;
        for (std::size_t i = 0; i < static_cast<std::size_t>(*count); ++i) {
          const auto value = source_.value(property.type, ascii_);
          if (!value) {
            return short_of();
          }
          if (!(*value >= 0 && *value < 4e9)) {
            return fail(RCode::kMeshIndex,
                        file_ + ": face " + std::to_string(index + 1) + " names vertex " + std::to_string(*value));
          }
          corners.push_back(static_cast<std::uint32_t>(*value));
        }
        if (element.name == "face" && (property.name == "vertex_indices" || property.name == "vertex_index")) {
          for (std::size_t i = 2; i < corners.size(); ++i) {
            mesh_.triangles.push_back({corners[0], corners[i - 1], corners[i]});
          }
        }
        continue;
      }
      const auto value = source_.value(property.type, ascii_);
      if (!value) {
        return short_of();
      }
      constexpr std::string_view kPlaces = "xyz";
      if (const std::size_t at = kPlaces.find(property.name);
          property.name.size() == 1 && at != std::string_view::npos) {
        p[static_cast<Eigen::Index>(at)] = *value;
      } else if (property.name == "s" || property.name == "u" || property.name == "texture_u") {
        uv.x() = *value;
        has_uv_ = true;
      } else if (property.name == "t" || property.name == "v" || property.name == "texture_v") {
        uv.y() = *value;
        has_uv_ = true;
      }
    }
    if (element.name == "vertex") {
      mesh_.vertices.push_back(p);
      mesh_.uv.push_back(uv);
    }
    return ok();
  }

  Source source_;
  std::string file_;
  bool ascii_ = true;
  std::vector<Element> elements_;
  bool has_uv_ = false;
  Mesh mesh_;
};

}  // namespace

Result<Mesh> read_ply(std::string_view bytes, const std::string& file) { return PlyReader(bytes, file).read(); }

}  // namespace raysteer::sim::scene
