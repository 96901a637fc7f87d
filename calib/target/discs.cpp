#include "calib/target/discs.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <variant>

namespace raysteer::calib::target {
namespace {

int id_bits(const DiscGrid& grid) { return static_cast<int>(std::bit_width(static_cast<unsigned>(grid.discs()))); }

/// Is disc `id` lit in picture `index`?
bool lit(const DiscGrid& grid, int id, int index) {
  const unsigned number = static_cast<unsigned>(id) + 1;
  if (index == 0) {
    return true;
  }
  if (index <= id_bits(grid)) {
    return ((number >> (index - 1)) & 1U) != 0;
  }
  return std::popcount(number) % 2 != 0;
}

/// Share of pixel (x, y) that a disc about the origin covers.
double coverage(double x, double y, double radius) {
  const double r = std::hypot(x, y);
  if (r < radius - 1) {
    return 1;
  }
  if (r > radius + 1) {
    return 0;
  }
  constexpr int kSide = 8;
  int inside = 0;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      inside += std::hypot(x + (i + 0.5) / kSide - 0.5, y + (j + 0.5) / kSide - 0.5) < radius ? 1 : 0;
    }
  }
  return static_cast<double>(inside) / (kSide * kSide);
}

/// Light of a picture as a share of the white panel's, pixel by pixel: free of the floor's print and the lamp's
/// fall-off.
template <class Pixel>
class Shares {
 public:
  Shares(const Image<Pixel>& black, const Image<Pixel>& white) : black_(black), white_(white) {
    // The brightest hundredth tells what "lit" is here.
    std::vector<float> lights;
    for (int y = 0; y < black.height(); y += 8) {
      for (int x = 0; x < black.width(); x += 8) {
        lights.push_back(light(white, x, y));
      }
    }
    const auto bright = lights.begin() + static_cast<std::ptrdiff_t>(lights.size() * 99 / 100);
    std::ranges::nth_element(lights, bright);
    least_ = 0.1F * *bright;
  }

  bool anything_lit() const { return least_ >= 1; }
  bool is_lit(int x, int y) const { return light(white_, x, y) >= least_; }
  /// At a lit pixel.
  float share(const Image<Pixel>& picture, int x, int y) const { return light(picture, x, y) / light(white_, x, y); }

 private:
  float light(const Image<Pixel>& picture, int x, int y) const {
    return static_cast<float>(picture(x, y)) - static_cast<float>(black_(x, y));
  }
  const Image<Pixel>& black_;
  const Image<Pixel>& white_;
  float least_ = 0;
};

/// The middle of the light in a window around a blob, its neighbourhood's grey taken off. Nothing when part of the
/// window is not lit, or lies outside.
template <class Pixel>
std::optional<Disc> measure(const Shares<Pixel>& shares, const Image<Pixel>& picture, const cv::Rect& box, int area) {
  const int margin = std::max(3, std::min(box.width, box.height) / 4);
  const cv::Rect window(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin);
  if (window.x < 0 || window.y < 0 || window.x + window.width > picture.width() ||
      window.y + window.height > picture.height()) {
    return std::nullopt;
  }
  const double middle_x = window.x + 0.5 * (window.width - 1);
  const double middle_y = window.y + 0.5 * (window.height - 1);
  double sum = 0, sum_x = 0, sum_y = 0, spread = 0;
  double ring = 0, ring_squares = 0;
  double moment_x = 0, moment_y = 0;
  int ring_pixels = 0;
  for (int y = window.y; y < window.y + window.height; ++y) {
    for (int x = window.x; x < window.x + window.width; ++x) {
      if (!shares.is_lit(x, y)) {
        return std::nullopt;
      }
      const double share = shares.share(picture, x, y);
      sum += share;
      sum_x += share * (x - middle_x);
      sum_y += share * (y - middle_y);
      moment_x += x - middle_x;
      moment_y += y - middle_y;
      spread += 0.5 * ((x - middle_x) * (x - middle_x) + (y - middle_y) * (y - middle_y));
      if (x == window.x || y == window.y || x == window.x + window.width - 1 || y == window.y + window.height - 1) {
        ring += share;
        ring_squares += share * share;
        ++ring_pixels;
      }
    }
  }
  const double ground = ring / ring_pixels;
  const double noise = std::sqrt(std::max(0.0, ring_squares / ring_pixels - ground * ground));
  const double light = sum - ground * window.area();
  // A neighbour's light in the ring, or a blob that is not a disc's.
  if (ground > 0.2 || noise > 0.1 || light < 0.5 * area) {
    return std::nullopt;
  }
  Disc disc;
  disc.q = {middle_x + (sum_x - ground * moment_x) / light, middle_y + (sum_y - ground * moment_y) / light};
  disc.radius_px = std::sqrt(light / std::numbers::pi);
  // White noise of the shares; the floor stands for what is no noise: the frames' rounding, the lamp's grain.
  disc.sigma_px = std::hypot(noise * std::sqrt(spread) / light, 0.01);
  return disc;
}

template <class Pixel>
std::optional<int> blinked(const DiscGrid& grid, const Shares<Pixel>& shares,
                           std::span<const Image<Pixel>* const> pictures, const Eigen::Vector2d& q) {
  const int x = static_cast<int>(std::lround(q.x()));
  const int y = static_cast<int>(std::lround(q.y()));
  unsigned number = 0;
  bool parity = false;
  for (int index = 1; index < grid.pictures(); ++index) {
    float share = 0;
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        share += shares.share(*pictures[static_cast<std::size_t>(index)], x + i, y + j) / 9;
      }
    }
    if (share > 0.3F && share < 0.7F) {
      return std::nullopt;
    }
    const bool on = share >= 0.7F;
    if (index <= id_bits(grid)) {
      number |= on ? 1U << (index - 1) : 0U;
    } else {
      parity = on;
    }
  }
  const int id = static_cast<int>(number) - 1;
  if (id < 0 || id >= grid.discs() || (std::popcount(number) % 2 != 0) != parity) {
    return std::nullopt;
  }
  return id;
}

template <class Pixel>
Result<std::vector<Disc>> detect(const DiscGrid& grid, const Image<Pixel>& black, const Image<Pixel>& white,
                                 std::span<const Image<Pixel>* const> pictures) {
  const Shares<Pixel> shares(black, white);
  if (!shares.anything_lit()) {
    return fail(RCode::kFramesBlack, "the white panel adds no light to what the camera sees");
  }
  cv::Mat1b bright(black.height(), black.width());
  for (int y = 0; y < black.height(); ++y) {
    std::uint8_t* row = bright.ptr(y);
    for (int x = 0; x < black.width(); ++x) {
      row[x] = shares.is_lit(x, y) && shares.share(*pictures[0], x, y) > 0.5F ? 255 : 0;
    }
  }
  cv::Mat labels, stats, centres;
  const int blobs = cv::connectedComponentsWithStats(bright, labels, stats, centres, 4, CV_32S);
  std::map<int, std::vector<Disc>> found;
  for (int blob = 1; blob < blobs; ++blob) {
    const int* row = stats.ptr<int>(blob);
    const cv::Rect box(row[cv::CC_STAT_LEFT], row[cv::CC_STAT_TOP], row[cv::CC_STAT_WIDTH], row[cv::CC_STAT_HEIGHT]);
    const int area = row[cv::CC_STAT_AREA];
    // An upright ellipse fills pi/4 of its box, a slanted one less.
    if (area < 20 || area < 0.4 * box.area() || area > 0.95 * box.area()) {
      continue;
    }
    auto disc = measure(shares, *pictures[0], box, area);
    const auto id = disc ? blinked(grid, shares, pictures, disc->q) : std::nullopt;
    if (id) {
      disc->id = *id;
      found[*id].push_back(*disc);
    }
  }
  std::vector<Disc> discs;
  for (const auto& [id, seen] : found) {
    if (seen.size() == 1) {
      discs.push_back(seen.front());
    }
  }
  if (discs.size() < 6) {
    return fail(RCode::kDiscsNotFound,
                std::to_string(discs.size()) + " of " + std::to_string(grid.discs()) + " discs, at least 6 are needed");
  }
  return discs;
}

}  // namespace

int DiscGrid::pictures() const { return 2 + id_bits(*this); }

DiscGrid fill_panel(int width, int height, int across) {
  DiscGrid grid;
  grid.pitch_px = width / across;
  grid.radius_px = 0.25 * grid.pitch_px;
  grid.columns = across;
  grid.rows = height / grid.pitch_px;
  grid.left_px = (width - 1 - grid.pitch_px * (grid.columns - 1)) / 2;
  grid.top_px = (height - 1 - grid.pitch_px * (grid.rows - 1)) / 2;
  return grid;
}

Image<std::uint8_t> disc_picture(const DiscGrid& grid, int panel_width, int panel_height, int index) {
  Image<std::uint8_t> picture(panel_width, panel_height);
  const int reach = static_cast<int>(std::ceil(grid.radius_px)) + 1;
  for (int id = 0; id < grid.discs(); ++id) {
    if (!lit(grid, id, index)) {
      continue;
    }
    const int cx = static_cast<int>(grid.centre(id).x());
    const int cy = static_cast<int>(grid.centre(id).y());
    for (int y = std::max(0, cy - reach); y <= std::min(panel_height - 1, cy + reach); ++y) {
      for (int x = std::max(0, cx - reach); x <= std::min(panel_width - 1, cx + reach); ++x) {
        picture(x, y) = static_cast<std::uint8_t>(std::lround(255 * coverage(x - cx, y - cy, grid.radius_px)));
      }
    }
  }
  return picture;
}

Result<std::vector<Disc>> detect_discs(const DiscGrid& grid, const Frame& black, const Frame& white,
                                       std::span<const Frame> pictures) {
  if (static_cast<int>(pictures.size()) != grid.pictures()) {
    return fail(RCode::kFrameCount, std::to_string(grid.pictures()) + " pictures of discs are needed, not " +
                                        std::to_string(pictures.size()));
  }
  return std::visit(
      [&]<class Pixel>(const Image<Pixel>& dark) -> Result<std::vector<Disc>> {
        const auto* bright = std::get_if<Image<Pixel>>(&white);
        std::vector<const Image<Pixel>*> images{bright};
        for (const Frame& picture : pictures) {
          images.push_back(std::get_if<Image<Pixel>>(&picture));
        }
        for (const Image<Pixel>* image : images) {
          if (image == nullptr) {
            return fail(RCode::kFrameDepth, "frames of 8 and of 16 bits do not go together");
          }
          if (image->width() != dark.width() || image->height() != dark.height()) {
            return fail(RCode::kFrameSize, "frames of one camera have different sizes");
          }
        }
        if (dark.empty()) {
          return fail(RCode::kFrameSize, "a frame is empty");
        }
        return detect<Pixel>(grid, dark, *bright, std::span(images).subspan(1));
      },
      black);
}

}  // namespace raysteer::calib::target
