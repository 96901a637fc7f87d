// What a person in the room sees.
#include "sim/app/grey_picture.hpp"
#include "sim/app/modes.hpp"
#include "sim/app/onlooker.hpp"
#include "sim/rig/showing.hpp"
#include "sim/world/png.hpp"

namespace raysteer::sim::app {

Result<Json> picture(const PictureRequest& request, Say& say) {
  Result<LoadedRig> loaded = load_rig(request.which);
  if (!loaded) {
    return std::move(loaded).error();
  }
  const proto::board::Projector& panel = loaded->board.projector;
  Image<std::uint8_t> content(panel.width, panel.height);
  content.fill(255);
  if (!request.content.empty()) {
    Result<Image<std::uint8_t>> read = read_grey(request.content);
    if (!read) {
      return std::move(read).error();
    }
    content = *std::move(read);
  }
  rig::PretendRig& rig = *loaded->rig;
  rig::Showing showing(rig, settle_timeout(loaded->board));
  const std::array<double, 2> mirror{1e-3 * request.mirror_mrad[0], 1e-3 * request.mirror_mrad[1]};
  say.progress("aiming", 0);
  RAYSTEER_TRY(showing.aim(mirror));
  RAYSTEER_TRY(showing.show(content.view()));
  say.progress("drawing the room", 0.5);
  const Image<std::uint8_t> seen = rig.world().room_picture(beside_the_light(rig), glance(rig));
  RAYSTEER_TRY(world::save_png(seen.view(), request.picture.string()));
  return Json{{"picture", request.picture.string()}, {"board", loaded->board.name}, {"scene", loaded->scene}};
}

}  // namespace raysteer::sim::app
