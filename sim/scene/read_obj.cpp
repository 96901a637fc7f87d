#include <charconv>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "sim/scene/mesh_check.hpp"
#include "sim/scene/read_scene.hpp"

namespace raysteer::sim::scene {
namespace {

std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::string_view kSpace = " \t\r";
  std::vector<std::string_view> words;
  for (std::size_t at = line.find_first_not_of(kSpace); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kSpace, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(kSpace, end);
  }
  return words;
}

// The whole word, or nothing; "nan" and "inf" are numbers here, so that they are told apart from garbage.
template <class Number>
bool read_number(std::string_view word, Number& number) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  return error == std::errc{} && end == word.data() + word.size();
}

class ObjReader {
 public:
  explicit ObjReader(std::string file) : file_(std::move(file)) {}

  Result<Mesh> read(std::string_view bytes) {
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
      ++line_;
      RAYSTEER_TRY(read_line(words_of(bytes.substr(at, end - at))));
      at = end + 1;
    }
    if (!has_uv_) {
      mesh_.uv.clear();
    }
    RAYSTEER_TRY(check_mesh(mesh_, file_));
    return std::move(mesh_);
  }

 private:
  Error wrong(const std::string& expected) const {
    return fail(RCode::kMeshSyntax, file_ + ":" + std::to_string(line_) + ": expected " + expected);
  }

  Status read_line(const std::vector<std::string_view>& words) {
    if (words.empty()) {
      return ok();
    }
    if (words[0] == "v") {
      Eigen::Vector3d p;
      if (words.size() < 4 || !read_number(words[1], p.x()) || !read_number(words[2], p.y()) ||
          !read_number(words[3], p.z())) {
        return wrong("'v' and three numbers");
      }
      points_.push_back(p);
    } else if (words[0] == "vt") {
      Eigen::Vector2d uv;
      if (words.size() < 3 || !read_number(words[1], uv.x()) || !read_number(words[2], uv.y())) {
        return wrong("'vt' and two numbers");
      }
      uv_.push_back(uv);
    } else if (words[0] == "f") {
      return read_face(words);
    }
    return ok();
  }

  Status read_face(const std::vector<std::string_view>& words) {
    if (words.size() < 4) {
      return wrong("'f' and at least three corners");
    }
    std::vector<std::uint32_t> corners;
    for (std::size_t i = 1; i < words.size(); ++i) {
      auto corner = read_corner(words[i]);
      RAYSTEER_TRY(corner);
      corners.push_back(*corner);
    }
    for (std::size_t i = 2; i < corners.size(); ++i) {
      mesh_.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    }
    return ok();
  }

  // "7", "7/3", "7//2" or "7/3/2"; counted from 1, or from the end when negative.
  Result<std::uint32_t> read_corner(std::string_view word) {
    const std::size_t slash = word.find('/');
    long point = 0;
    long uv = 0;
    if (!read_number(word.substr(0, slash), point)) {
      return wrong("a corner like 7, 7/3 or 7/3/2, got '" + std::string(word) + "'");
    }
    if (slash != std::string_view::npos) {
      const std::string_view rest = word.substr(slash + 1, word.find('/', slash + 1) - slash - 1);
      if (!rest.empty() && !read_number(rest, uv)) {
        return wrong("a corner like 7, 7/3 or 7/3/2, got '" + std::string(word) + "'");
      }
    }
    const auto from_start = [](long index, std::size_t count) {
      return index < 0 ? index + static_cast<long>(count) : index - 1;
    };
    const long p = from_start(point, points_.size());
    const long t = uv == 0 ? -1 : from_start(uv, uv_.size());
    if (p < 0 || p >= static_cast<long>(points_.size()) || t >= static_cast<long>(uv_.size()) || (uv != 0 && t < 0)) {
      return fail(RCode::kMeshIndex, file_ + ":" + std::to_string(line_) + ": '" + std::string(word) + "' of " +
                                         std::to_string(points_.size()) + " vertices and " +
                                         std::to_string(uv_.size()) + " texture points so far");
    }
    const auto [found, is_new] = seen_.try_emplace({p, t}, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) {
      mesh_.vertices.push_back(points_[static_cast<std::size_t>(p)]);
      mesh_.uv.push_back(t < 0 ? Eigen::Vector2d(0, 0) : uv_[static_cast<std::size_t>(t)]);
      has_uv_ = has_uv_ || t >= 0;
    }
    return found->second;
  }

  std::string file_;
  int line_ = 0;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Eigen::Vector2d> uv_;
  std::map<std::pair<long, long>, std::uint32_t> seen_;
  bool has_uv_ = false;
  Mesh mesh_;
};

}  // namespace

Result<Mesh> read_obj(std::string_view bytes, const std::string& file) { return ObjReader(file).read(bytes); }

}  // namespace raysteer::sim::scene
