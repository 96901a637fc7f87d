#include "host/report/page.hpp"

#include <fmt/core.h>

#include "host/report/html.hpp"

namespace raysteer::host::report {
namespace {

std::string list(const std::vector<std::string>& items, const char* title) {
  if (items.empty()) {
    return {};
  }
  std::string text = fmt::format("<h3>{}</h3>\n<ul>\n", title);
  for (const std::string& item : items) {
    text += fmt::format("<li>{}</li>\n", escape(item));
  }
  return text + "</ul>\n";
}

std::string judgement_section(const Judgement& judgement) {
  return fmt::format("<header class=\"{0}\">\n<p class=\"verdict\">{0}</p>\n<h1>{1}</h1>\n", escape(judgement.verdict),
                     escape(judgement.summary)) +
         list(judgement.reasons, "Why") + list(judgement.advice, "What to do") + "</header>\n";
}

}  // namespace

std::string page(const AnyResult& result, const std::filesystem::path&) {
  const Judgement& judgement =
      std::visit([](const auto& known) -> const Judgement& { return known.judgement; }, result);
  return "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>Raysteer report</title>\n" +
         judgement_section(judgement) + "</html>\n";
}

}  // namespace raysteer::host::report
