// What was printed is what was asked: other programs draw the file, and the target is found in it at its scale.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdlib>

#include "calib/target/datum.hpp"
#include "calib/target/detect.hpp"
#include "hal/base/datum_code.hpp"
#include "host/session/image_codec.hpp"
#include "tests/contract/cli/program.hpp"

namespace raysteer::host::cli {
namespace {

using support::Finished;
using support::ScratchFolder;

// Edges fall off the pixel grid, as in a camera.
constexpr double kDpi = 187;

struct Case {
  const char* name = "";
  TargetSpec target;
  std::vector<std::string> words;
};

std::vector<std::string> print_words(const Case& wanted, const std::string& file) {
  std::vector<std::string> words{"target", "print", "--out", file, "--quiet"};
  words.insert(words.end(), wanted.words.begin(), wanted.words.end());
  return words;
}

// A lens blurs: (1 2 1)/4 both ways.
Image<std::uint8_t> softened(const Image<std::uint8_t>& sharp) {
  Image<std::uint8_t> soft = sharp.clone();
  for (int y = 1; y + 1 < sharp.height(); ++y) {
    for (int x = 1; x + 1 < sharp.width(); ++x) {
      int sum = 8;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          sum += (2 - std::abs(dx)) * (2 - std::abs(dy)) * sharp(x + dx, y + dy);
        }
      }
      soft(x, y) = static_cast<std::uint8_t>(sum / 16);
    }
  }
  return soft;
}

// Scale of one axis, and the largest distance of a corner from where that scale puts it, mm.
struct Line {
  double scale = 0;
  double worst_mm = 0;
};
Line fit_line(const std::vector<Eigen::Vector2d>& wanted_and_seen) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& pair : wanted_and_seen) {
    mean += pair / static_cast<double>(wanted_and_seen.size());
  }
  double xx = 0, xy = 0;
  for (const Eigen::Vector2d& pair : wanted_and_seen) {
    xx += (pair.x() - mean.x()) * (pair.x() - mean.x());
    xy += (pair.x() - mean.x()) * (pair.y() - mean.y());
  }
  Line line{xy / xx, 0};
  for (const Eigen::Vector2d& pair : wanted_and_seen) {
    line.worst_mm = std::max(line.worst_mm, std::abs(pair.y() - mean.y() - line.scale * (pair.x() - mean.x())));
  }
  return line;
}

// Corners found in the drawing are where the target says: its size along both axes, turned nowhere.
void expect_true_to_scale(const Case& wanted, const std::string& image) {
  const std::string bytes = support::read_all(image);
  Image<std::uint8_t> frame;
  const Status decoded =
      session::decode_image({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, frame);
  ASSERT_TRUE(decoded) << decoded.error().message();
  const Result<calib::target::Detection> found = calib::target::detect(wanted.target, softened(frame).view());
  ASSERT_TRUE(found) << found.error().message();
  ASSERT_EQ(static_cast<int>(found->corners.size()), wanted.target.corners());
  std::vector<Eigen::Vector2d> across, down;
  for (const calib::target::Corner& corner : found->corners) {
    const Eigen::Vector3d p = 1000 * calib::target::corner_position(wanted.target, corner.id);
    const Eigen::Vector2d seen = corner.q * 25.4 / kDpi;
    across.emplace_back(p.x(), seen.x());
    down.emplace_back(p.y(), seen.y());
  }
  // pdftoppm puts edges on quarters of a pixel: 0.25 px at both ends are 0.07 mm, and 4e-4 of 175 mm.
  // Taking 72.27 points for an inch would be ten times that.
  for (const Line& line : {fit_line(across), fit_line(down)}) {
    EXPECT_NEAR(line.scale, 1, 5e-4);
    EXPECT_LT(line.worst_mm, 0.3 * 25.4 / kDpi);
  }
}

class Printed : public ::testing::TestWithParam<Case> {};

TEST_P(Printed, pdf_shows_the_target_at_its_size) {
  if (support::run_program({"sh", "-c", "command -v pdftoppm"}).exit_code != 0) {
    GTEST_SKIP() << "pdftoppm is not installed";
  }
  const ScratchFolder folder;
  const Finished done = raysteer(print_words(GetParam(), (folder / "t.pdf").string()));
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const Finished drawn = support::run_program(
      {"pdftoppm", "-r", "187", "-gray", "-singlefile", (folder / "t.pdf").string(), (folder / "t").string()});
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_EQ(drawn.err, "") << "the PDF has no faults";
  expect_true_to_scale(GetParam(), (folder / "t.pgm").string());
}

TEST_P(Printed, svg_shows_the_target_at_its_size) {
  if (support::run_program({"sh", "-c", "command -v rsvg-convert"}).exit_code != 0) {
    GTEST_SKIP() << "rsvg-convert is not installed";
  }
  const ScratchFolder folder;
  ASSERT_EQ(raysteer(print_words(GetParam(), (folder / "t.svg").string())).exit_code, 0);
  const Finished drawn = support::run_program(
      {"rsvg-convert", "-d", "187", "-p", "187", "-o", (folder / "t.png").string(), (folder / "t.svg").string()});
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  expect_true_to_scale(GetParam(), (folder / "t.png").string());
}

Case chessboard() {
  Case wanted;
  wanted.name = "chessboard";
  wanted.target.columns = 8;
  wanted.target.rows = 5;
  wanted.target.square_m = 0.022;
  wanted.words = {"--columns", "8", "--rows", "5", "--square-mm", "22"};
  return wanted;
}

Case charuco(const char* name, int columns, int rows, const std::string& dictionary, CharucoLayout layout) {
  Case wanted;
  wanted.name = name;
  wanted.target.kind = TargetKind::kCharuco;
  wanted.target.columns = columns;
  wanted.target.rows = rows;
  wanted.target.square_m = 0.025;
  wanted.target.marker_m = 0.018;
  wanted.target.dictionary = dictionary;
  wanted.target.layout = layout;
  wanted.words = {"--kind",       "charuco",
                  "--columns",    std::to_string(columns),
                  "--rows",       std::to_string(rows),
                  "--square-mm",  "25",
                  "--marker-mm",  "18",
                  "--dictionary", dictionary,
                  "--layout",     layout == CharucoLayout::kLegacy ? "legacy" : "current"};
  return wanted;
}

// What GoogleTest prints of a case that failed.
void PrintTo(const Case& wanted, std::ostream* out) { *out << wanted.name; }

INSTANTIATE_TEST_SUITE_P(Targets, Printed,
                         ::testing::Values(chessboard(), charuco("charuco", 8, 5, "5X5_100", CharucoLayout::kCurrent),
                                           charuco("even_rows_legacy", 7, 6, "4X4_50", CharucoLayout::kLegacy)),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(TargetPrint, writes_the_block_for_the_session_at_the_measured_size) {
  const std::vector<std::string> words{"target", "print", "--columns", "8", "--rows", "5", "--square-mm", "22"};
  EXPECT_EQ(raysteer(words).out, "[[target]]\nkind = \"chessboard\"\ncolumns = 8\nrows = 5\nsquare_m = 0.022\n");
  std::vector<std::string> measured = words;
  measured.insert(measured.end(), {"--measured-mm", "199"});
  const Finished done = raysteer(measured);
  EXPECT_NE(done.out.find("square_m = 0.02189\n"), std::string::npos) << done.out;
  measured.back() = "99";
  EXPECT_EQ(raysteer(measured).exit_code, 2) << "no measurement of a bar of 200 mm";
}

TEST(TargetPrint, says_what_would_fit) {
  const ScratchFolder folder;
  const Finished done = raysteer(
      {"target", "print", "--columns", "9", "--rows", "6", "--square-mm", "30", "--out", (folder / "t.pdf").string()});
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_NE(done.err.find("error[R0507]"), std::string::npos) << done.err;
  EXPECT_NE(done.err.find("--square-mm 24 or --paper A3 would fit"), std::string::npos) << done.err;
  EXPECT_TRUE(folder.names().empty());
}

TEST(TargetPrint, refuses_more_markers_than_the_dictionary_has) {
  const Finished done = raysteer({"target", "print", "--kind", "charuco", "--columns", "14", "--rows", "9",
                                  "--square-mm", "10", "--dictionary", "4X4_50"});
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_NE(done.err.find("needs 63 markers, 4X4_50 has 50"), std::string::npos) << done.err;
}

// All codes on one sheet, as the detector reads them from what other programs draw.
void expect_all_datums(const std::string& image, double radius_mm) {
  const std::string bytes = support::read_all(image);
  Image<std::uint8_t> frame;
  const Status decoded =
      session::decode_image({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, frame);
  ASSERT_TRUE(decoded) << decoded.error().message();
  const calib::target::DatumsInFrame found = calib::target::detect_datums(softened(frame).view());
  EXPECT_TRUE(found.doubled.empty());
  ASSERT_EQ(found.seen.size(), datum_codes().size());
  double pitch_mm = 0;
  for (std::size_t k = 0; k < found.seen.size(); ++k) {
    EXPECT_EQ(found.seen[k].code, datum_codes()[k]);
    EXPECT_NEAR(found.seen[k].radius_px() * 25.4 / kDpi, radius_mm, 0.01 * radius_mm + 0.05);
    EXPECT_GT(found.seen[k].margin, 0.5);
    if (k == 1) {
      pitch_mm = (found.seen[1].q - found.seen[0].q).norm() * 25.4 / kDpi;
    }
  }
  EXPECT_NEAR(pitch_mm, 7 * radius_mm + 4, 0.1) << "side by side, 4 mm between";
}

TEST(DatumPrint, pdf_and_svg_show_all_sixteen_at_their_size) {
  const ScratchFolder folder;
  for (const std::string& kind : {std::string("pdf"), std::string("svg")}) {
    const std::string file = (folder / ("t." + kind)).string();
    const Finished done = raysteer({"target", "print", "--kind", "datum", "--radius-mm", "5.5", "--out", file});
    ASSERT_EQ(done.exit_code, 0) << done.err;
    EXPECT_NE(done.out.find("code = 1391\nradius_m = 0.0055\n"), std::string::npos) << done.out;
  }
  if (support::run_program({"sh", "-c", "command -v pdftoppm && command -v rsvg-convert"}).exit_code != 0) {
    GTEST_SKIP() << "pdftoppm or rsvg-convert is not installed";
  }
  const Finished pdf = support::run_program(
      {"pdftoppm", "-r", "187", "-gray", "-singlefile", (folder / "t.pdf").string(), (folder / "p").string()});
  ASSERT_EQ(pdf.exit_code, 0) << pdf.err;
  EXPECT_EQ(pdf.err, "") << "the PDF has no faults";
  expect_all_datums((folder / "p.pgm").string(), 5.5);
  const Finished svg = support::run_program(
      {"rsvg-convert", "-d", "187", "-p", "187", "-o", (folder / "s.png").string(), (folder / "t.svg").string()});
  ASSERT_EQ(svg.exit_code, 0) << svg.err;
  expect_all_datums((folder / "s.png").string(), 5.5);
}

TEST(DatumPrint, takes_the_measured_size_and_refuses_what_cannot_be) {
  const auto print = [](std::vector<std::string> more) {
    more.insert(more.begin(), {"target", "print", "--kind", "datum"});
    return raysteer(more);
  };
  const Finished measured = print({"--code", "23", "--radius-mm", "20", "--measured-mm", "99.5"});
  EXPECT_NE(measured.out.find("code = 23\nradius_m = 0.0199\n"), std::string::npos) << measured.out << measured.err;
  const Finished twin = print({"--code", "24", "--radius-mm", "20"});
  EXPECT_EQ(twin.exit_code, 1);
  EXPECT_NE(twin.err.find("take one of"), std::string::npos) << twin.err;
  const Finished large = print({"--code", "23", "--code", "79", "--radius-mm", "30"});
  EXPECT_NE(large.err.find("error[R0507]"), std::string::npos) << large.err;
  EXPECT_NE(large.err.find("--radius-mm 19"), std::string::npos) << large.err;
  EXPECT_EQ(print({"--code", "23", "--code", "23", "--radius-mm", "9"}).exit_code, 2);
  EXPECT_EQ(print({"--code", "one", "--radius-mm", "9"}).exit_code, 2);
  EXPECT_EQ(print({}).exit_code, 2);
  EXPECT_EQ(print({"--radius-mm", "9", "--columns", "3"}).exit_code, 2);
}

}  // namespace
}  // namespace raysteer::host::cli
