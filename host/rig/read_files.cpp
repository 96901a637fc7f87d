#include "host/rig/read_files.hpp"

#include <string_view>
#include <utility>

#include "host/exchange/rig_file.hpp"
#include "host/exchange/write_file.hpp"
#include "host/rig/drawing.hpp"
#include "host/sim/find_file.hpp"

namespace raysteer::host::rig {
namespace {

template <class Read>
auto read(const std::string& kind, const std::string& name, const Read& parse) -> decltype(parse("", "")) {
  const auto file = sim::find_file(kind, name);
  RAYSTEER_TRY(file);
  const auto text = exchange::read_file(*file);
  RAYSTEER_TRY(text);
  return parse(*text, file->string());
}

}  // namespace

Result<proto::board::Board> read_board(const std::string& name) {
  return read("boards", name, proto::board::read_board);
}

Result<SurveyFile> read_survey(const std::string& name) {
  return read("surveys", name, [](std::string_view text, const std::string& file) -> Result<SurveyFile> {
    auto survey = proto::survey::read_survey(text, file);
    RAYSTEER_TRY(survey);
    return SurveyFile{*std::move(survey), exchange::survey_id(text)};
  });
}

Result<proto::stations::Stations> read_stations(const std::string& name) {
  return read("stations", name, proto::stations::read_stations);
}

Result<calib::steer::Drawing> read_drawing(const std::string& name) {
  const auto board = read_board(name);
  RAYSTEER_TRY(board);
  return drawing_of(*board);
}

}  // namespace raysteer::host::rig
