// What is given to the pretend rig wrongly is refused by name, and leaves nothing half-written.
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <thread>

#include "tests/contract/sim/sim_program.hpp"

namespace raysteer::sim {
namespace {

TEST_F(SimProgram, refuses_a_board_with_an_unknown_key) {
  const fs::path board = changed("boards", "mock-small", "lumens", "lumen");
  expect_refused(capture({"--board", board.string()}), "R0105", 1, "did you mean 'lumens'");
}

TEST_F(SimProgram, refuses_a_board_in_wrong_units) {
  const fs::path board = changed("boards", "mock-small", "max_angle_mrad", "max_angle_deg");
  expect_refused(capture({"--board", board.string()}), "R0105", 1, "'max_angle_mrad'");
}

TEST_F(SimProgram, refuses_a_board_whose_back_end_it_has_not) {
  const fs::path board = changed("boards", "mock-small", "back_end = \"mock\"", "back_end = \"mok\"");
  expect_refused(capture({"--board", board.string()}), "R0107", 1, "did you mean 'mock'");
}

TEST_F(SimProgram, names_the_boards_it_has_for_one_it_has_not) {
  expect_refused(capture({"--board", "mock-smal"}), "R0101", 3, "did you mean 'mock-small'");
}

TEST_F(SimProgram, refuses_a_scene_with_an_unknown_key) {
  const fs::path scene =
      write("bad.toml", "format = 1\nname = \"bad\"\n[[plane]]\nname = \"floor\"\nsize_mm = [1, 1]\n");
  expect_refused(capture({"--scene", scene.string()}), "R0105", 1, "size_m");
}

TEST_F(SimProgram, refuses_a_mesh_without_faces_and_one_that_is_not_a_number) {
  const fs::path scene =
      write("mesh.toml", "format = 1\nname = \"mesh\"\n[[mesh]]\nname = \"part\"\nfile = \"part.obj\"\n");
  write("part.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  expect_refused(capture({"--scene", scene.string()}), "R0803", 1, "part.obj");
  write("part.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_refused(capture({"--scene", scene.string()}), "R0804", 1, "part.obj");
}

TEST_F(SimProgram, refuses_a_plan_with_an_unknown_key_or_unit) {
  const fs::path plan = write("plan.toml", "format = 1\nname = \"p\"\n[[look]]\nname = \"a\"\nmirror_deg = [0, 0]\n");
  expect_refused(capture({"--looks", plan.string()}), "R0105", 1, "'mirror_mrad'");
}

TEST_F(SimProgram, refuses_a_look_outside_the_limits_before_anything_moves) {
  const fs::path plan =
      write("plan.toml", "format = 1\nname = \"p\"\n[[look]]\nname = \"far\"\nmirror_mrad = [0, 900]\n");
  expect_refused(capture({"--looks", plan.string()}), "R0603", 1, "far");
}

TEST_F(SimProgram, refuses_what_its_room_cannot_prepare) {
  const fs::path plan =
      write("plan.toml",
            "format = 1\nname = \"p\"\n[[look]]\nname = \"a\"\nmirror_mrad = [0, 0]\nprepare = \"target pose 99\"\n");
  expect_refused(capture({"--looks", plan.string()}), "R0808", 1, "99");
}

TEST_F(SimProgram, refuses_a_fault_nobody_knows_with_the_nearest_one) {
  expect_refused(capture({"--fault", "left.dorp"}), "R0107", 1, "drop");
  expect_refused(capture({"--fault", "lefty.drop"}), "R0107", 1, "did you mean 'left'");
}

TEST_F(SimProgram, says_when_the_projector_lights_nothing) {
  expect_refused(capture({"--fault", "projector.lamp-off"}), "R0712", 1, "");
}

TEST_F(SimProgram, says_when_the_mirror_never_settles) {
  const fs::path plan =
      write("plan.toml", "format = 1\nname = \"p\"\n[[look]]\nname = \"aside\"\nmirror_mrad = [50, 0]\n");
  expect_refused(capture({"--fault", "mirror.stuck", "--looks", plan.string()}), "R0710", 7, "aside");
}

TEST_F(SimProgram, says_when_it_cannot_write) {
  write("file", "");
  const support::Finished finished =
      raysteer({"capture", "--sim", "--json", "--board", "mock-small", "--out", (work() / "file" / "out").string()});
  EXPECT_EQ(code_of(finished), "R0116") << finished.out;
  EXPECT_EQ(finished.exit_code, 1);
}

TEST_F(SimProgram, says_when_raysteer_sim_is_not_there) {
  fs::copy_file(support::program_folder() / "raysteer", work() / "raysteer");
  const support::Finished finished =
      support::run_program({(work() / "raysteer").string(), "capture", "--sim", "--json", "--out", out().string()});
  EXPECT_EQ(code_of(finished), "R0809") << finished.out;
  EXPECT_EQ(finished.exit_code, 3);
  EXPECT_NE(finished.out.find("raysteer-sim"), std::string::npos);
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(SimProgram, an_interrupted_capture_leaves_nothing) {
  const std::string program = (support::program_folder() / "raysteer").string();
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl(program.c_str(), "raysteer", "capture", "--sim", "--quiet", "--paced", "--board", "mock-small", "--out",
            out().c_str(), nullptr);
    ::_exit(127);
  }
  // Until it has begun to write its hidden folder.
  while (fs::is_empty(work())) {
    std::this_thread::yield();
  }
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(support::exit_code_of(status), 8);
  EXPECT_TRUE(fs::is_empty(work()));
}

}  // namespace
}  // namespace raysteer::sim
