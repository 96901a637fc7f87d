#include "hal/base/rcode.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "hal/base/result.hpp"

namespace raysteer {
namespace {

struct Row {
  RCode rcode;
  Explanation text;
};

// One row a code, in rising order. tools/check_rcodes.py checks that every enumerator has one.
constexpr std::array kRows{
    Row{RCode::kNone, {ErrorCode::kUnknown, "none", "no fault", "Nothing is wrong.", "Nothing to do."}},
    Row{RCode::kFileMissing,
        {ErrorCode::kNotFound, "file-missing", "a file is missing", "The path is misspelt, or the file was moved.",
         "Check the path; it is relative to the folder you started the command in."}},
    Row{RCode::kFileUnreadable,
        {ErrorCode::kPermissionDenied, "file-unreadable", "a file cannot be read",
         "Permissions, or a folder where a file was expected.",
         "Check the file with 'ls -l'; make it readable for your user."}},
    Row{RCode::kFileTruncated,
        {ErrorCode::kDataLoss, "file-truncated", "a file ends too early",
         "An interrupted copy or a full disk when it was written.", "Copy or record the file again."}},
    Row{RCode::kTomlSyntax,
        {ErrorCode::kInvalidArgument, "toml-syntax", "a file is not valid TOML",
         "A quote, bracket or equals sign is missing near the line named.",
         "Mend the line named; docs/session-format.md shows complete examples."}},
    Row{RCode::kUnknownKey,
        {ErrorCode::kInvalidArgument, "unknown-key", "a key is not known here",
         "A misspelt key, or one from a newer format.",
         "Use the key suggested, or remove the line; docs/session-format.md lists every key."}},
    Row{RCode::kMissingKey,
        {ErrorCode::kInvalidArgument, "missing-key", "a required key is missing",
         "The file was written by hand and a line was forgotten.",
         "Add the key named; docs/session-format.md says what it means."}},
    Row{RCode::kBadValue,
        {ErrorCode::kInvalidArgument, "bad-value", "a value is not usable",
         "A wrong type or unit, or a number outside its range.", "Give a value of the kind and range named."}},
    Row{RCode::kPathOutside,
        {ErrorCode::kPermissionDenied, "path-outside", "a path leaves the session and the frames root",
         "A '..' or an absolute path in the session's file names.",
         "Put the frames under the session's folder, or name their folder with --frames DIR."}},
    Row{RCode::kCircularInclude,
        {ErrorCode::kInvalidArgument, "circular-include", "session files include each other in a circle",
         "A file includes itself, directly or through others.", "Remove one of the 'include' lines named."}},
    Row{RCode::kFrameMissing,
        {ErrorCode::kNotFound, "frame-missing", "a frame file is missing",
         "The frames are elsewhere, the file-name template does not fit, or a shot was lost.",
         "Name the frames' folder with --frames DIR, correct the template in the session, or record the shot again."}},
    Row{RCode::kFrameSize,
        {ErrorCode::kInvalidArgument, "frame-size", "a frame has another size than the others",
         "A frame from another camera mode or another set.",
         "Record the session with one camera mode, or remove the foreign frame."}},
    Row{RCode::kFrameDepth,
        {ErrorCode::kInvalidArgument, "frame-depth", "a frame has another bit depth than the session says",
         "The session says 8 bits and the file holds 16, or the other way round.",
         "Set 'bits' of the camera in the session to what the files hold."}},
    Row{RCode::kFrameFormat,
        {ErrorCode::kInvalidArgument, "frame-format", "a frame is not a readable image",
         "Not a PNG, JPEG, PGM or BMP file, or its data are damaged.", "Record or convert the frame again."}},
    Row{RCode::kFormatVersion,
        {ErrorCode::kFailedPrecondition, "format-version", "a file has a format version this program does not know",
         "It was written by a newer Raysteer.", "Use the Raysteer version that wrote it, or a newer one."}},
    Row{RCode::kDiskFull,
        {ErrorCode::kResourceExhausted, "disk-full", "the disk is full", "No space left where the output goes.",
         "Free space or choose another --out; nothing half-written was left."}},
    Row{RCode::kWriteFailed,
        {ErrorCode::kUnavailable, "write-failed", "a file cannot be written",
         "Permissions, a read-only disk, or a missing folder.",
         "Choose an --out you can write to; nothing half-written was left."}},
    Row{RCode::kFrameCount,
        {ErrorCode::kInvalidArgument, "frame-count", "there are more or fewer frames than the pattern sequence has",
         "Frames were lost, or the sequence in the session does not describe them.",
         "Compare the counts named; correct the sequence or record again."}},
    Row{RCode::kFramesOutOfOrder,
        {ErrorCode::kFailedPrecondition, "frames-out-of-order", "frames are in the wrong order",
         "Files were renamed or sorted as text ('10' before '2').",
         "Restore the recorded order; the frames named do not show the patterns the sequence expects there."}},
    Row{RCode::kFramesDoubled,
        {ErrorCode::kFailedPrecondition, "frames-doubled", "two frames show the same pattern",
         "The camera ran faster than the projector, or a shot was repeated.",
         "Record again with a trigger or a longer pause between pattern and shot."}},
    Row{RCode::kInverseSwapped,
        {ErrorCode::kFailedPrecondition, "inverse-swapped", "patterns and their inverses are swapped",
         "The inverse was projected first, or the session describes the other order.",
         "Set 'inverse_first = true' on the block in the session."}},
    Row{RCode::kFramesBlack,
        {ErrorCode::kFailedPrecondition, "frames-black", "the frames are black",
         "Lens cap, projector off or asleep, or exposure far too short.",
         "Check that the projector shows light and the lens is open, then lengthen the exposure."}},
    Row{RCode::kFramesSaturated,
        {ErrorCode::kFailedPrecondition, "frames-saturated", "the frames are saturated",
         "Exposure or gain too high, or a shiny scene.",
         "Shorten the exposure until the white frame stays below 250 of 255."}},
    Row{RCode::kSceneMoved,
        {ErrorCode::kFailedPrecondition, "scene-moved", "something moved between the frames",
         "Someone walked through, or camera, board or projector was touched during the sequence.",
         "Keep the scene still and record this look again."}},
    Row{RCode::kNothingDecoded,
        {ErrorCode::kFailedPrecondition, "nothing-decoded", "no pixel could be decoded",
         "The camera does not see the projection, or the sequence does not describe the frames.",
         "Look at the white frame: the projected field must be visible; check the sequence with 'raysteer session "
         "check'."}},
    Row{RCode::kBadSequence,
        {ErrorCode::kInvalidArgument, "bad-sequence", "the pattern sequence cannot be decoded",
         "Too few bits for the panel, too few steps, or a phase without anything that orders its periods.",
         "Correct the sequence in the session as the message says."}},
    Row{RCode::kTargetNotFound,
        {ErrorCode::kFailedPrecondition, "target-not-found", "the calibration board was not found",
         "Out of focus, too dark, partly outside, or the session describes another board.",
         "Look at the frame named; check type, size and dictionary of the board in the session."}},
    Row{RCode::kTooFewViews,
        {ErrorCode::kFailedPrecondition, "too-few-views", "too few views of the board",
         "Fewer usable views than unknowns can be told apart with.",
         "Record at least 10 views with the board tilted about both axes at three distances."}},
    Row{RCode::kCoplanarViews,
        {ErrorCode::kFailedPrecondition, "coplanar-views", "the views are too alike to calibrate from",
         "The board was only shifted, never tilted: focal length and distance cannot be told apart.",
         "Add views with the board tilted by 20 to 45 degrees about both axes."}},
    Row{RCode::kWrongTarget,
        {ErrorCode::kFailedPrecondition, "wrong-target", "the board does not have the size the session says",
         "Columns, rows or squares were counted differently, or another board was used.",
         "Count inner corners for a chessboard, squares for a ChArUco board, and correct the session."}},
    Row{RCode::kMirroredTarget,
        {ErrorCode::kFailedPrecondition, "mirrored-target", "the board is seen mirrored",
         "The image is flipped, the board was seen in a mirror, or printed mirrored.",
         "Switch off image flipping in the camera; print the board unmirrored."}},
    Row{RCode::kForeignView,
        {ErrorCode::kFailedPrecondition, "foreign-view", "a view shows another board than the others",
         "Two boards were mixed in one session.", "Remove the view named, or make a session of its own for it."}},
    Row{RCode::kTargetScaleMissing,
        {ErrorCode::kFailedPrecondition, "target-scale-missing", "the board's scale is missing",
         "No 'square_m' in the session: lengths would have no unit.",
         "Measure at least 8 squares with a steel rule, divide, and set 'square_m' in metres."}},
    Row{RCode::kCameraMovedDuringCapture,
        {ErrorCode::kFailedPrecondition, "camera-moved-during-capture", "a camera moved during the capture",
         "The camera or its bar was nudged between the views named.",
         "Fasten the cameras and record the session again."}},
    Row{RCode::kSolverDiverged,
        {ErrorCode::kInternal, "solver-diverged", "the calibration did not converge",
         "The views contradict each other or determine too little.",
         "Look at the views named; remove the worst and add well-tilted ones."}},
    Row{RCode::kTooFewCorrespondences,
        {ErrorCode::kFailedPrecondition, "too-few-correspondences", "too few correspondences",
         "Little of the board is lit by the projector, or decoding failed on it.",
         "Move the board so that the projected field covers it."}},
    Row{RCode::kBadCalibrationFile,
        {ErrorCode::kInvalidArgument, "bad-calibration-file", "the calibration file is not usable",
         "It was edited by hand, damaged, or is no calibration.", "Make it again with 'raysteer calibrate cameras'."}},
    Row{RCode::kNotFinite,
        {ErrorCode::kInvalidArgument, "not-finite", "a number is not finite",
         "NaN or infinity where a number is needed, usually from a failed calibration or an edited file.",
         "Make the file again with 'raysteer calibrate'; never repair numbers by hand."}},
    Row{RCode::kCameraCount,
        {ErrorCode::kInvalidArgument, "camera-count", "the session has the wrong number of cameras",
         "A stereo step needs two cameras, a projector step at least one.", "Use a session with the cameras named."}},
    Row{RCode::kTooFewMatches,
        {ErrorCode::kFailedPrecondition, "too-few-matches", "too few points are seen by both cameras",
         "The cameras see different parts of the projection, or the calibration does not belong to them.",
         "Check that both cameras see the lit scene and that left and right are not swapped."}},
    Row{RCode::kPoseMoved,
        {ErrorCode::kFailedPrecondition, "pose-moved", "left and right moved since calibration",
         "The camera bar was bent, bumped, or remounted.",
         "Scan again with --refit-pose, or calibrate the cameras again."}},
    Row{RCode::kCalibrationMismatch,
        {ErrorCode::kFailedPrecondition, "calibration-mismatch", "the calibration does not belong to this session",
         "Other camera names or another image size.",
         "Use the calibration made with these cameras at this resolution."}},
    Row{RCode::kUsage,
        {ErrorCode::kInvalidArgument, "usage", "the command line is not understood",
         "A misspelt command or option, or a missing argument.",
         "See 'raysteer --help' or 'raysteer COMMAND --help'."}},
    Row{RCode::kOutputExists,
        {ErrorCode::kAlreadyExists, "output-exists", "the output folder exists and is not ours",
         "The folder named with --out holds files that Raysteer did not write.",
         "Choose another --out, or empty the folder."}},
    Row{RCode::kCancelled,
        {ErrorCode::kCancelled, "cancelled", "cancelled", "Ctrl-C or a termination signal.",
         "Run the same command again; nothing half-written was left."}},
    Row{RCode::kUnknownCode,
        {ErrorCode::kNotFound, "unknown-code", "there is no such code", "The code is misspelt.",
         "List all codes with 'raysteer explain --list'."}},
    Row{RCode::kNothingToReport,
        {ErrorCode::kNotFound, "nothing-to-report", "there is nothing to report here",
         "The folder holds no result.json of a calibration or a scan.",
         "Run 'raysteer calibrate' or 'raysteer scan' with --out DIR first."}},
    Row{RCode::kInternal,
        {ErrorCode::kInternal, "internal", "something failed inside Raysteer",
         "A fault in Raysteer, or no memory left.",
         "Free memory and try again; if it stays, report it with the command line and the message."}},
    Row{RCode::kTargetDoesNotFit,
        {ErrorCode::kInvalidArgument, "target-does-not-fit", "the target does not fit on the paper",
         "Squares times their size, the white margin and the ruler need more room than the paper has.",
         "Use the largest square named, fewer squares, or larger paper."}},
};

constexpr auto kCodes = [] {
  std::array<RCode, kRows.size() - 1> codes{};
  for (std::size_t i = 1; i < kRows.size(); ++i) {
    codes[i - 1] = kRows[i].rcode;
  }
  return codes;
}();

static_assert(std::ranges::is_sorted(kRows, {}, &Row::rcode), "rows stand in rising order");

}  // namespace

const Explanation& explain(RCode rcode) {
  const auto found = std::ranges::lower_bound(kRows, rcode, {}, &Row::rcode);
  RAYSTEER_CHECK(found != kRows.end() && found->rcode == rcode);
  return found->text;
}

std::span<const RCode> all_rcodes() { return kCodes; }

std::string to_string(RCode rcode) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "R%04d", static_cast<int>(rcode));
  return text.data();
}

}  // namespace raysteer
