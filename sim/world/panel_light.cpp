#include "sim/world/panel_light.hpp"

#include <algorithm>
#include <cmath>

#include "sim/world/rows.hpp"

namespace raysteer::sim::world {
namespace {

int reach(double sigma_px) { return static_cast<int>(std::ceil(5 * sigma_px)) + 1; }

/// Half of a normalised Gaussian, from the middle out.
std::vector<float> gaussian(double sigma) {
  std::vector<float> weights;
  double sum = 0;
  for (int i = 0; i <= reach(sigma); ++i) {
    const double weight = std::exp(-0.5 * i * i / (sigma * sigma));
    weights.push_back(static_cast<float>(weight));
    sum += i == 0 ? weight : 2 * weight;
  }
  for (float& weight : weights) {
    weight = static_cast<float>(weight / sum);
  }
  return weights;
}

}  // namespace

AxisLight::AxisLight(std::vector<float> light, int begin, int end, const std::vector<bool>& levels)
    : profiles_(levels.size()) {
  begin = std::clamp(begin, 0, static_cast<int>(light.size()));
  end = std::clamp(end, begin, static_cast<int>(light.size()));
  std::fill(light.begin(), light.begin() + begin, 0.0F);
  std::fill(light.begin() + end, light.end(), 0.0F);
  level_light_ = begin < end ? light[static_cast<std::size_t>(begin)] : 0;
  plain_ = std::all_of(light.begin() + begin, light.begin() + end, [&](float one) { return one == level_light_; });
  for (std::size_t level = 0; level < levels.size(); ++level) {
    const double sigma = blur_sigma(static_cast<int>(level));
    inner_begin_[level] = begin - 0.5 + 5 * sigma;
    inner_end_[level] = end - 0.5 - 5 * sigma;
    if (levels[level]) {
      profiles_[level].emplace(light, sigma);
    }
  }
}

FlatLight::FlatLight(const hal::mock::PanelPicture& picture, int first_row, int end_row,
                     const std::vector<bool>& levels, int threads)
    : pictures_(levels.size() / kEvery + 1) {
  for (std::size_t i = 0; i < pictures_.size(); ++i) {
    bool needed = false;
    for (std::size_t level = i * kEvery; level < std::min((i + 1) * kEvery, levels.size()); ++level) {
      needed = needed || levels[level];
    }
    if (!needed) {
      continue;
    }
    // Bilinear look-up widens by 1/6 px^2, a square panel pixel is 1/12 px^2 wide.
    const double sigma = blur_sigma(static_cast<int>(i) * kEvery + 1);
    const std::vector<float> weights = gaussian(std::sqrt(std::max(sigma * sigma - 1.0 / 12, 1e-4)));
    const int border = static_cast<int>(weights.size()) + 1;
    const int width = picture.width + 2 * border;
    const int height = picture.height + 2 * border;
    const auto source = [&](int y, std::vector<float>& row) {
      std::fill(row.begin(), row.end(), 0.0F);
      if (y >= std::max(first_row, 0) && y < std::min(end_row, picture.height)) {
        for (int x = 0; x < picture.width; ++x) {
          row[static_cast<std::size_t>(x + border)] = picture.light(x, y);
        }
      }
    };
    Image<float> across(width, height);
    for_rows(height, threads, [&](int first, int end) {
      std::vector<float> row(static_cast<std::size_t>(width));
      for (int y = first; y < end; ++y) {
        source(y - border, row);
        float* out = across.row(y);
        const int inner = static_cast<int>(weights.size()) - 1;
        for (int x = inner; x < width - inner; ++x) {
          float sum = weights[0] * row[static_cast<std::size_t>(x)];
          for (int k = 1; k <= inner; ++k) {
            sum += weights[static_cast<std::size_t>(k)] *
                   (row[static_cast<std::size_t>(x - k)] + row[static_cast<std::size_t>(x + k)]);
          }
          out[x] = sum;
        }
      }
    });
    Blurred& blurred = pictures_[i];
    blurred.border = border;
    blurred.light = Image<float>(width, height);
    for_rows(height, threads, [&](int first, int end) {
      const int inner = static_cast<int>(weights.size()) - 1;
      for (int y = std::max(first, inner); y < std::min(end, height - inner); ++y) {
        float* out = blurred.light.row(y);
        for (int k = -inner; k <= inner; ++k) {
          const float weight = weights[static_cast<std::size_t>(std::abs(k))];
          const float* from = across.row(y + k);
          for (int x = 0; x < width; ++x) {
            out[x] += weight * from[x];
          }
        }
      }
    });
  }
}

float FlatLight::mean(double centre_x, double centre_y, const Footprint& at) const {
  const Blurred& picture = pictures_[static_cast<std::size_t>((at.blur_x + at.blur_y) / 2 / kEvery)];
  const Image<float>& light = picture.light;
  if (light.empty()) {
    return 0;  // no footprint has this blur
  }
  const auto most_x = static_cast<float>(light.width()) - 1.001F;
  const auto most_y = static_cast<float>(light.height()) - 1.001F;
  // Midpoints less than 0.7 px apart: bilinear light hardly bends in between.
  const int columns = std::clamp(static_cast<int>(at.wide / 0.7F) + 1, 1, 12);
  const int rows = std::clamp(static_cast<int>(at.high / 0.7F) + 1, 1, 12);
  const float step_x = at.wide / static_cast<float>(columns);
  const float step_y = at.high / static_cast<float>(rows);
  const float first_x = static_cast<float>(centre_x + picture.border) - 0.5F * (at.wide - step_x);
  const float first_y = static_cast<float>(centre_y + picture.border) - 0.5F * (at.high - step_y);
  float sum = 0;
  for (int row = 0; row < rows; ++row) {
    const float y = std::clamp(first_y + static_cast<float>(row) * step_y, 0.0F, most_y);
    const auto j = static_cast<int>(y);
    const float v = y - static_cast<float>(j);
    const float* upper = light.row(j);
    const float* lower = light.row(j + 1);
    for (int column = 0; column < columns; ++column) {
      const float x = std::clamp(first_x + static_cast<float>(column) * step_x, 0.0F, most_x);
      const auto i = static_cast<int>(x);
      const float u = x - static_cast<float>(i);
      sum += (1 - v) * ((1 - u) * upper[i] + u * upper[i + 1]) + v * ((1 - u) * lower[i] + u * lower[i + 1]);
    }
  }
  return sum / static_cast<float>(columns * rows);
}

PanelLight::PanelLight(const hal::mock::PanelPicture& picture, int first_row, int end_row, const Standing& standing,
                       const std::vector<bool>& levels, int threads)
    : standing_(standing) {
  if (!picture.along) {
    flat_.emplace(picture, first_row, end_row, levels, threads);
    return;
  }
  std::vector<float> pattern;
  for (const std::uint8_t code : picture.profile) {
    pattern.push_back(picture.response[code]);
  }
  const bool columns = *picture.along == Axis::kX;
  const std::vector<float> ones(static_cast<std::size_t>(columns ? picture.height : picture.width), 1.0F);
  along_x_.emplace(columns ? pattern : ones, 0, picture.width, levels);
  along_y_.emplace(columns ? ones : pattern, first_row, end_row, levels);
}

void PanelLight::add(std::span<const Footprint> row, float weight, float* out) const {
  for (std::size_t x = 0; x < row.size(); ++x) {
    if (row[x].gain > 0) {
      out[x] += weight * row[x].gain * mean(row[x]);
    }
  }
}

void PanelLight::add(std::span<const PartFootprint> parts, float weight, float* row) const {
  for (const PartFootprint& part : parts) {
    row[part.column] += weight * part.at.gain * mean(part.at);
  }
}

}  // namespace raysteer::sim::world
