#include "host/report/page.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "host/report/figures.hpp"
#include "host/report/html.hpp"
#include "host/report/picture.hpp"
#include "host/report/svg.hpp"

namespace raysteer::host::report {
namespace {

// A device as full as any real one: 300 views of 150 corners.
DeviceResult full_device(const std::string& name) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.1);
  std::uniform_real_distribution<double> place(0, 1500);
  DeviceResult device;
  device.name = name;
  device.kind = "camera";
  device.width = 2048;
  device.height = 1500;
  device.lens = "bc5";
  device.rms_px = 0.15;
  for (int i = 0; i < 45000; ++i) {
    device.residuals.push_back({i / 150, place(random), place(random), noise(random), noise(random), i % 50 != 0});
  }
  device.coverage = {5, 4, std::vector<double>(20, 120)};
  device.uncertainty_px = {10, 8, std::vector<double>(80, 0.04)};
  device.uncertainty_px.values[3] = kUnknown;
  device.odd_even_px = device.uncertainty_px;
  device.parameters = {{name + ".fx", 2600, 0.3, "px"}, {name + ".k3", 0, kUnknown, ""}};
  return device;
}

CalibrationResult full_result() {
  CalibrationResult result;
  result.judgement = {"usable", "Usable: <b>bold</b> & \"quoted\".", {"a < b"}, {"Add views."}};
  result.session = "<script>alert(1)</script>";
  result.devices = {full_device("left"), full_device("right"), full_device("beamer")};
  result.devices[2].kind = "projector";
  for (int i = 0; i < 300; ++i) {
    result.views.push_back({"view_" + std::to_string(i), i != 7, "R0306", "foreign", {0.1, 0.2, kUnknown}, 0.3, 1});
  }
  result.differences = {{"left", {2, 1, {0.1, 0.2}}, {2, 1, {0.3, 0.4}}, 1.5, 0.1, 0.2}};
  result.lenses = {{"left", "bc5", 0.17, true, true}};
  return result;
}

// Every element that opens closes, in order: what browsers forgive and other readers do not.
std::string first_unbalanced(const std::string& html) {
  std::vector<std::string> open;
  for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
    const std::size_t end = html.find('>', at);
    if (end == std::string::npos) {
      return html.substr(at, 60);
    }
    const std::string tag = html.substr(at + 1, end - at - 1);
    const std::string name = tag.substr(0, tag.find_first_of(" /\n", 1));
    if (tag.starts_with('!') || tag.ends_with('/') || name == "meta" || name == "img") {
      continue;
    }
    if (tag.starts_with('/')) {
      if (open.empty() || open.back() != tag.substr(1)) {
        return tag;
      }
      open.pop_back();
    } else {
      open.push_back(name);
    }
  }
  return open.empty() ? "" : open.back();
}

TEST(Page, is_small_self_contained_and_balanced) {
  const std::string html = page(full_result(), "/nowhere");
  EXPECT_LT(html.size(), 1'500'000U);
  EXPECT_GT(html.size(), 100'000U);
  for (const std::string outside : {"http:", "https:", "<script", "<link", "@import", "src=\"/"}) {
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
  }
  EXPECT_EQ(first_unbalanced(html), "");
  EXPECT_EQ(html.find("nan"), std::string::npos);
}

TEST(Page, begins_with_the_verdict_in_one_sentence) {
  const std::string html = page(full_result(), "/nowhere");
  const std::size_t body = html.find("<header");
  EXPECT_EQ(
      html.find("<p class=\"verdict\">usable</p>\n<h1>Usable: &lt;b&gt;bold&lt;/b&gt; &amp; &quot;quoted&quot;.</h1>"),
      html.find("<p class", body));
  EXPECT_LT(html.find("a &lt; b"), html.find("<h2>"));
  EXPECT_LT(html.find("Add views."), html.find("<h2>"));
}

TEST(Page, has_each_of_the_promised_parts) {
  const std::string html = page(full_result(), "/nowhere");
  for (const std::string part : {"Residuals by place", "Coverage", "Uncertainty of the projection",
                                 "Odd against even views", "Against the earlier calibration", "The same in millimetres",
                                 "not used: foreign (R0306)", "Parameters", "Lens models tried"}) {
    EXPECT_NE(html.find(part), std::string::npos) << part;
  }
}

TEST(Page, of_nothing_known_is_still_a_page) {
  EXPECT_EQ(first_unbalanced(page(CalibrationResult{}, "/nowhere")), "");
  EXPECT_EQ(first_unbalanced(page(ScanResult{}, "/nowhere")), "");
}

TEST(Page, reads_no_picture_outside_its_folder) {
  ScanResult scan;
  for (const std::string name : {"../../etc/passwd", "/etc/passwd", ".."}) {
    scan.picture = name;
    EXPECT_EQ(page(scan, "/").find("<img"), std::string::npos) << name;
  }
}

TEST(ResidualGrid, is_the_rms_of_what_was_kept) {
  std::vector<ResidualVector> residuals(4, {0, 5, 5, 3, 4, true});
  residuals.push_back({0, 5, 5, 300, 400, false});
  residuals.push_back({0, 95, 95, 1, 0, true});  // alone in its cell: says nothing
  const Grid grid = residual_grid(residuals, 100, 100);
  EXPECT_DOUBLE_EQ(grid.at(0, 0), 5);
  EXPECT_TRUE(std::isnan(grid.at(9, 9)));
}

TEST(CloudPicture, is_a_png_of_what_was_seen) {
  std::vector<PanelPoint> points;
  for (int i = 100; i < 140; ++i) {
    for (int j = 50; j < 70; ++j) {
      points.push_back(
          {i, j, 0.001F * static_cast<float>(i), 0.001F * static_cast<float>(j), 1 + 0.001F * static_cast<float>(i)});
    }
  }
  const std::string png = cloud_picture(points, 640, 400);
  ASSERT_GT(png.size(), 33U);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(static_cast<unsigned char>(png[19]), 40) << "width: only the part of the panel with points";
  EXPECT_EQ(static_cast<unsigned char>(png[23]), 20) << "height";
  EXPECT_EQ(cloud_picture({}, 640, 400), "");
}

TEST(NiceStep, is_one_two_or_five) {
  EXPECT_DOUBLE_EQ(nice_step(10, 5), 2);
  EXPECT_DOUBLE_EQ(nice_step(0.7, 5), 0.2);
  EXPECT_DOUBLE_EQ(nice_step(2048, 6), 500);
  EXPECT_DOUBLE_EQ(nice_step(0, 6), 1);
}

TEST(Labels, have_the_digits_they_need) {
  EXPECT_EQ(tick_label(0.05, 0.05), "0.05");
  EXPECT_EQ(tick_label(0.2, 0.1), "0.2");
  EXPECT_EQ(tick_label(500, 100), "500");
  EXPECT_EQ(tick_label(1e-18, 0.1), "0");
  EXPECT_EQ(brief(0.16249), "0.162");
  EXPECT_EQ(brief(12.345), "12.3");
  EXPECT_EQ(brief(kUnknown), "–");
}

TEST(Base64, is_that_of_rfc_4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace raysteer::host::report
