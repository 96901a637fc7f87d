#include "host/exchange/sheet.hpp"

#include <fmt/core.h>

#include <string_view>
#include <vector>

namespace raysteer::host::exchange {
namespace {

constexpr double kPointsPerMm = 72 / 25.4;

std::string ascii(std::string_view words) {
  std::string safe;
  for (const char letter : words) {
    safe += letter >= ' ' && letter <= '~' ? letter : '?';
  }
  return safe;
}

std::string pdf_string(std::string_view words) {
  std::string safe;
  for (const char letter : ascii(words)) {
    if (letter == '(' || letter == ')' || letter == '\\') {
      safe += '\\';
    }
    safe += letter;
  }
  return "(" + safe + ")";
}

std::string xml(std::string_view words) {
  std::string safe;
  for (const char letter : ascii(words)) {
    safe += letter == '&' ? "&amp;" : letter == '<' ? "&lt;" : std::string(1, letter);
  }
  return safe;
}

}  // namespace

std::string to_pdf(const Sheet& sheet) {
  // PDF counts y upwards. Six decimals of a point are a third of a nanometre.
  std::string content = "0 g\n";
  for (const Sheet::Rectangle& r : sheet.black) {
    content +=
        fmt::format("{:.6f} {:.6f} {:.6f} {:.6f} re\n", r.x * kPointsPerMm,
                    (sheet.height_mm - r.y - r.height) * kPointsPerMm, r.width * kPointsPerMm, r.height * kPointsPerMm);
  }
  content += sheet.black.empty() ? "" : "f\n";
  for (const Sheet::Outline& outline : sheet.outlines) {
    content += outline.white ? "1 g\n" : "0 g\n";
    const char* step = "m";
    for (const auto& [x, y] : outline.corners) {
      content += fmt::format("{:.6f} {:.6f} {}\n", x * kPointsPerMm, (sheet.height_mm - y) * kPointsPerMm, step);
      step = "l";
    }
    content += "h f\n";
  }
  content += sheet.outlines.empty() ? "" : "0 g\n";
  for (const Sheet::Text& text : sheet.texts) {
    content += fmt::format("BT /F1 {:.3f} Tf {:.6f} {:.6f} Td {} Tj ET\n", text.size_mm * kPointsPerMm,
                           text.x * kPointsPerMm, (sheet.height_mm - text.y) * kPointsPerMm, pdf_string(text.words));
  }
  const std::vector<std::string> objects{
      "<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
      "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
      fmt::format("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.6f} {:.6f}] /Contents 5 0 R "
                  "/Resources << /Font << /F1 4 0 R >> >> >>",
                  sheet.width_mm * kPointsPerMm, sheet.height_mm * kPointsPerMm),
      "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>",
      fmt::format("<< /Length {} >>\nstream\n{}endstream", content.size(), content),
      fmt::format("<< /Title {} /Producer (raysteer {}) >>", pdf_string(sheet.title), RAYSTEER_VERSION),
  };
  std::string pdf = "%PDF-1.4\n";
  std::string table = fmt::format("xref\n0 {}\n0000000000 65535 f \n", objects.size() + 1);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    table += fmt::format("{:010} 00000 n \n", pdf.size());
    pdf += fmt::format("{} 0 obj\n{}\nendobj\n", i + 1, objects[i]);
  }
  const std::size_t start = pdf.size();
  return pdf + table +
         fmt::format("trailer\n<< /Size {} /Root 1 0 R /Info 6 0 R >>\nstartxref\n{}\n%%EOF\n", objects.size() + 1,
                     start);
}

std::string to_svg(const Sheet& sheet) {
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}mm\" "
      "height=\"{1:g}mm\" viewBox=\"0 0 {0:g} {1:g}\">\n<title>{2}</title>\n<rect width=\"{0:g}\" height=\"{1:g}\" "
      "fill=\"#fff\"/>\n<path fill=\"#000\" d=\"",
      sheet.width_mm, sheet.height_mm, xml(sheet.title));
  for (const Sheet::Rectangle& r : sheet.black) {
    text += fmt::format("M{:.6f} {:.6f}h{:.6f}v{:.6f}h-{:.6f}z\n", r.x, r.y, r.width, r.height, r.width);
  }
  text += "\"/>\n";
  for (const Sheet::Outline& outline : sheet.outlines) {
    text += fmt::format("<path fill=\"#{}\" d=\"", outline.white ? "fff" : "000");
    char step = 'M';
    for (const auto& [x, y] : outline.corners) {
      text += fmt::format("{}{:.6f} {:.6f}", step, x, y);
      step = 'L';
    }
    text += "z\"/>\n";
  }
  for (const Sheet::Text& line : sheet.texts) {
    text += fmt::format(
        "<text x=\"{:.6f}\" y=\"{:.6f}\" font-size=\"{:g}\" font-family=\"Helvetica, Arial, "
        "sans-serif\">{}</text>\n",
        line.x, line.y, line.size_mm, xml(line.words));
  }
  return text + "</svg>\n";
}

}  // namespace raysteer::host::exchange
