// value: every fault Raysteer can name, and what to do about it.
//
// One table for the device and the laptop: the daemon's events, `raysteer explain` and docs/errors.md read it.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace raysteer {

/// The canonical codes that gRPC and Connect share, so that mapping to the wire is the identity.
enum class ErrorCode {
  kCancelled = 1,
  kUnknown = 2,
  kInvalidArgument = 3,
  kDeadlineExceeded = 4,
  kNotFound = 5,
  kAlreadyExists = 6,
  kPermissionDenied = 7,
  kResourceExhausted = 8,
  kFailedPrecondition = 9,
  kAborted = 10,
  kOutOfRange = 11,
  kUnimplemented = 12,
  kInternal = 13,
  kUnavailable = 14,
  kDataLoss = 15,
  kUnauthenticated = 16,
};

/// Hundreds group by the way of the light: 1 files and sessions, 2 decoding, 3 calibration, 4 scanning, 5 the tool
/// itself, 6 devices, 7 capture, 8 the pretend world, 9 the steered rig and its room, 10 tables and stations, 11 the
/// device's state, 12 its store, 13 the wire. A number is never used for another fault later.
enum class RCode : int {
  kNone = 0,

  // 01xx files and sessions
  kFileMissing = 101,
  kFileUnreadable = 102,
  kFileTruncated = 103,
  kTomlSyntax = 104,
  kUnknownKey = 105,
  kMissingKey = 106,
  kBadValue = 107,
  kPathOutside = 108,
  kCircularInclude = 109,
  kFrameMissing = 110,
  kFrameSize = 111,
  kFrameDepth = 112,
  kFrameFormat = 113,
  kFormatVersion = 114,
  kDiskFull = 115,
  kWriteFailed = 116,

  // 02xx decoding
  kFrameCount = 201,
  kFramesOutOfOrder = 202,
  kFramesDoubled = 203,
  kInverseSwapped = 204,
  kFramesBlack = 205,
  kFramesSaturated = 206,
  kSceneMoved = 207,
  kNothingDecoded = 208,
  kBadSequence = 209,

  // 03xx calibration
  kTargetNotFound = 301,
  kTooFewViews = 302,
  kCoplanarViews = 303,
  kWrongTarget = 304,
  kMirroredTarget = 305,
  kForeignView = 306,
  kTargetScaleMissing = 307,
  kCameraMovedDuringCapture = 308,
  kSolverDiverged = 309,
  kTooFewCorrespondences = 310,
  kBadCalibrationFile = 311,
  kNotFinite = 312,
  kCameraCount = 313,
  kDiscsNotFound = 314,
  kLookNotSolved = 315,

  // 04xx scanning
  kTooFewMatches = 401,
  kPoseMoved = 402,
  kCalibrationMismatch = 403,
  kSurfacesApart = 404,

  // 05xx the tool itself
  kUsage = 501,
  kOutputExists = 502,
  kCancelled = 503,
  kUnknownCode = 504,
  kNothingToReport = 505,
  kInternal = 506,
  kTargetDoesNotFit = 507,

  // 06xx devices
  kDeviceUnavailable = 601,
  kTooLate = 602,
  kMirrorOutOfRange = 603,
  kMirrorSensor = 604,
  kInterlockOpen = 605,
  kInterlockTripped = 606,
  kPanelSize = 607,
  kNothingStored = 608,
  kProjectorBusy = 609,
  kDeviceFull = 610,
  kNotArmed = 611,
  kNotConfigured = 612,
  kCameraSerial = 613,
  kCameraStreaming = 614,
  kCameraSettings = 615,
  kBandwidth = 616,
  kBlobMissing = 617,
  kDataLoss = 618,
  kStoreReadOnly = 619,
  kMirrorFollowing = 620,
  kMirrorStuck = 621,
  kOverTemperature = 622,
  kTickLate = 623,
  kKeepOut = 624,
  kDwellBudget = 625,
  kDisplayChanged = 626,
  kInterlockFlaps = 627,

  // 07xx capture and plan
  kShotIncomplete = 701,
  kShotSequence = 702,
  kShotApart = 703,
  kTriggerEdgeMissing = 704,
  kTriggerEdgeExtra = 705,
  kShotDamaged = 706,
  kAutomaticExposure = 707,
  kWrongPattern = 708,
  kFlipLate = 709,
  kMirrorNotSettled = 710,
  kMirrorMoved = 711,
  kNothingLit = 712,
  kTooBright = 713,
  kTooDark = 714,
  kOutOfFocus = 715,
  kLatencyUnknown = 716,
  kNoCameraClock = 717,
  kCaptureForeign = 718,

  // 08xx the pretend world
  kMeshMissing = 801,
  kMeshSyntax = 802,
  kMeshEmpty = 803,
  kMeshNotFinite = 804,
  kMeshIndex = 805,
  kTextureMissing = 806,
  kTextureFormat = 807,
  kBadPrepare = 808,
  kPretendRigMissing = 809,
  kPretendRigDied = 810,

  // 09xx the steered rig and its room
  kTooFewLooks = 901,
  kLookForeign = 902,
  kAxisReversed = 903,
  kPictureMirrored = 904,
  kRigMoved = 905,
  kRigNotSolved = 906,
  kDrawingsDisagree = 907,
  kSceneTooFlat = 908,
  kTooLittleParallax = 909,
  kScaleWrong = 910,
  kCommandMissing = 911,
  kFeedbackDisagrees = 912,
  kDatumsMissing = 913,
  kDatumMoved = 914,
  kDatumsExchanged = 915,
  kSurveyUnusable = 916,

  // 10xx tables and stations
  kTableDamaged = 1001,
  kTableVersion = 1002,
  kTableBound = 1003,
  kStationOutOfReach = 1004,
  kStationUnknown = 1005,
  kSurfaceMissing = 1006,

  // 11xx the device's state
  kFaultLatched = 1101,
  kLeaseHeld = 1102,
  kNotNow = 1103,
  kPastDeadline = 1104,
  kWatchdog = 1105,
  kStartLoop = 1106,

  // 12xx tables on the device
  kSetForeign = 1201,
  kTrialExpired = 1202,
  kNoTrial = 1203,
  kSlotDamaged = 1204,
  kNoTables = 1205,
  kStoreNewer = 1206,
  kQuota = 1207,
  kChunkDamaged = 1208,
  kOffsetWrong = 1209,
  kObjectMissing = 1210,
  kBackupDamaged = 1211,

  // 13xx the wire
  kUnreachable = 1301,
  kNotPaired = 1302,
  kRoleTooLow = 1303,
  kPairingRefused = 1304,
  kTooManyTries = 1305,
  kPeerChanged = 1306,
  kMalformed = 1307,
  kTooLarge = 1308,
  kNoSuchMethod = 1309,
  kTooBusy = 1310,
  kDisconnected = 1311,
};

struct Explanation {
  ErrorCode code;
  std::string_view name;      ///< "frame-missing"
  std::string_view sentence;  ///< literal, begins an error message
  std::string_view cause;     ///< why it usually happens
  std::string_view remedy;    ///< what to do next
};

/// The row of `rcode`. tools/check_rcodes.py fails when an enumerator has none.
const Explanation& explain(RCode rcode);

/// All codes in rising order, kNone left out.
std::span<const RCode> all_rcodes();

/// "R0110"
std::string to_string(RCode rcode);

}  // namespace raysteer
