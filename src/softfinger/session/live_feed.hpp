#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/contact/contact_sums.hpp"
#include "softfinger/device/device.hpp"
#include "softfinger/finger/finger_size.hpp"
#include "softfinger/geometry/pose.hpp"
#include "softfinger/geometry/signed_distance.hpp"
#include "softfinger/recording/latency_stages.hpp"
#include "softfinger/tracking/xr_hand.hpp"
#include "softfinger/twin/rendering_measures.hpp"

namespace softfinger {

/// What stays the same while one scene runs: enough to draw it. Lengths in m.
struct SceneDescription {
  struct Object {
    std::string name;
    Shape shape;
    std::vector<Vector3> positions_O;           ///< of a soft one at rest: what can be touched
    std::vector<std::array<int, 3>> triangles;  ///< indices into these, outward
    std::string hand;                           ///< whose bone it is; empty: none's
    bool can_be_held = false;                   ///< by LiveRequest::Kind::kHold
    std::string joint;                          ///< kind of the one it moves by; empty: none
  };
  struct Finger {
    std::string name;
    std::vector<Vector3> skin_rest_positions_F;      ///< one per skin sample
    std::vector<std::array<int, 3>> skin_triangles;  ///< indices into skin samples, outward
    std::vector<Vector3> rigid_positions_F;          ///< vertices of bone and nail surfaces
    std::vector<std::array<int, 3>> bone_triangles;  ///< indices into rigid_positions_F
    std::vector<std::array<int, 3>> nail_triangles;  ///< indices into rigid_positions_F
    std::string device_kind;                         ///< empty: no device
    std::string device_kind_words;                   ///< what people call it
    bool cables = false;                             ///< its linkage is of cables
    std::vector<std::string> configuration_names;    ///< with unit: pitch_deg, ...
    /// Places in SceneDescription::objectives of those that the device can have.
    std::vector<int> objectives;
    bool linear_joints = false;  ///< joints are lengths
    double disk_radius = 0.0;    ///< of devices that have one
    int legs = 0;
    std::vector<Shape> pieces;  ///< of the device's solid, at home
    double cap_radius = 0.0;    ///< see Device
    WorkspaceOutline workspace;
    bool twin = false;        ///< whether snapshots have one
    bool moved_here = false;  ///< by the page: its tracker is "page"
    bool in_headset = false;  ///< its tracker is "webxr": it follows this of a hand
    HandSide hand_side = HandSide::kRight;
    HandFinger hand_finger = HandFinger::kIndex;
    bool registrable = false;    ///< what its tracker follows can be registered, for a person
    bool fittable = false;       ///< its device can learn who wears it, for a person,
    bool fits_by_touch = false;  ///< who tells each touch: it has no force sensor
    Pose X_WFt_start;            ///< where it is before anybody moves it
  };
  /// What a person should know of a finger's device before it moves.
  struct Notice {
    std::size_t finger = 0;  ///< which of `fingers`
    std::string kind;        ///< one word for what it is about, e.g. force_limit, approach
    std::string text;        ///< one line
  };
  /// What a device can be led by.
  struct LeadingObjective {
    std::string name;
    std::string words;  ///< what people call it
  };
  std::uint64_t generation = 0;          ///< grows with each scene or restart
  std::string scene_name;                ///< file stem, e.g. "sphere"
  std::vector<std::string> scene_names;  ///< what the page may choose from
  double duration = 0.0;                 ///< s; 0: endless
  std::vector<Object> objects;
  std::vector<Finger> fingers;
  std::vector<Notice> notices;
  std::vector<LeadingObjective> objectives;  ///< all there are
};

/// Whether devices of a run are stopped: as asked, and as a fact.
struct DevicesStopped {
  bool asked = false;      ///< any of them
  bool confirmed = false;  ///< all that are asked retract, as those say that lead their servos
};

/// State of the loop at one instant, as the page draws it. Vectors keep their size while a scene
/// runs, so that filling one allocates nothing.
struct Snapshot {
  /// Skin in contact, one entry per sample.
  struct Skin {
    std::vector<Eigen::Vector3f> positions_F;  ///< m
    std::vector<float> pressures;              ///< Pa
    std::vector<std::uint8_t> in_contact;      ///< 1 where skin around the sample touches
  };
  /// A rigid part of the device's solid.
  struct Piece {
    Pose X_FS;
    double ball_radius = 0.0;  ///< m, of a ball, which may grow; 0 for other shapes
  };
  /// The second finger, pressed by the device, with the sums of its contact.
  struct Twin : ContactSums {
    bool pressed = false;  ///< not yet, or there is none: what follows means nothing
    Skin skin;
    RenderingMeasures measures;  ///< against the virtual contact that led to the command
    double cpu_time = 0.0;       ///< s, of the press
  };
  /// The surface of a soft object as it stands.
  struct SoftObject {
    std::size_t object = 0;                    ///< which of the scene's
    std::vector<Eigen::Vector3f> positions_O;  ///< m, in the order of its description
  };
  /// A finger with the sums of its virtual contact.
  struct Finger : ContactSums {
    Pose X_WFt;                   ///< tracked
    bool tracked = false;         ///< else X_WFt is the last known
    double tracked_time = 0.0;    ///< s, when X_WFt was true
    Pose X_WF;                    ///< simulated
    Skin skin;                    ///< virtual
    double deviation = 0.0;       ///< E of the last match, m^2
    Configuration configuration;  ///< commanded q
    Configuration actual;         ///< q where the servos say they are; empty: they do not
    JointAngles joints;           ///< commanded; rad, or m for linear ones
    std::int64_t tick = -1;       ///< of the commanded q; -1: none yet
    int objective = 0;            ///< that led to it: its place in SceneDescription::objectives
    StageTimes stages;            ///< of that tick
    Pose X_FP;                    ///< platform of the commanded q
    /// Per leg: base joint, knee, platform joint; m, in F; commanded.
    std::vector<Eigen::Vector3f> linkage_F;
    std::vector<Piece> pieces;  ///< of the commanded q
    std::string device_state;   ///< ready, rendering, holding, retracting, ...; at most 15 chars
    /// How long ago who leads the servos, and says device_state, last showed life, s; NaN: nobody
    /// does.
    double device_said = std::numeric_limits<double>::quiet_NaN();
    bool force_limited = false;  ///< the device would advance further but for its limit of force
    Twin twin;
  };
  std::uint64_t generation = 0;  ///< of the SceneDescription it belongs to
  std::uint64_t step = 0;
  double time = 0.0;       ///< s, simulated
  double wall_time = 0.0;  ///< s, on the monotonic clock: when this was taken
  bool paused = false;
  std::uint32_t stops = 0;  ///< how often devices were stopped so far; see kRelease
  DevicesStopped stopped;
  bool finished = false;        ///< the script has come to its end
  double step_cpu_time = 0.0;   ///< s, of the last step
  double match_cpu_time = 0.0;  ///< s, of the last match
  std::uint64_t deadline_misses = 0;
  std::vector<Pose> X_WO;                ///< one per object
  std::vector<SoftObject> soft_objects;  ///< those that there are, in the order of the scene
  std::vector<Finger> fingers;
};

/// What the page may ask of a live run.
struct LiveRequest {
  enum class Kind {
    kPause,
    kResume,
    kRestart,
    kScene,
    kObjective,  ///< of one finger's device
    kPose,
    kHold,     ///< an object: a person has it there; to be asked again and again
    kLetGo,    ///< of it
    kStop,     ///< the devices; latched
    kRelease,  ///< asks to, from the stop that a snapshot told of
    kRegister,
    kCancelRegistration,
    kFit,
    kCancelFit,
    kFelt,    ///< the wearer tells a touch of a fit
    kReload,  ///< not of the page: the person's file has changed
  };
  Kind kind = Kind::kPause;
  std::string scene;             ///< for kScene: one of SceneDescription::scene_names
  std::uint64_t generation = 0;  ///< for kRelease: of that snapshot
  std::uint32_t stops = 0;       ///< for kRelease: of that snapshot
  std::string objective;         ///< for kObjective: its name
  std::size_t finger = 0;        ///< for kObjective, kPose, kRegister, kFit: which of the scene's
  bool again = false;            ///< for kFit: see DeviceFitOptions
  std::string object;            ///< for kHold, kLetGo: its name
  Pose X_W;                      ///< for kPose X_WFt, for kHold X_WO: where the person wants it
  FingerSize measured;           ///< for kRegister
  std::optional<double> table_height;  ///< for kRegister: z of W, m; see RegistrationTask
};

/// A registration that the page asked for.
struct RegistrationState {
  enum class Phase { kIdle, kRunning, kSaved, kRefused };
  Phase phase = Phase::kIdle;
  std::size_t finger = 0;    ///< which of the scene's
  std::size_t held = 0;      ///< postures that were held
  std::size_t postures = 0;  ///< that there are
  std::string_view wanted;   ///< name of the posture to hold now
  std::string_view words;    ///< how, one sentence
  double progress = 0.0;     ///< of holding it, 0 to 1
  std::string message;       ///< what was found, or why nothing was saved
};

/// A fit of a device to its wearer that the page asked for.
struct FitState {
  enum class Phase {
    kIdle,
    kWaiting,  ///< until the run has ended and the device is retracted
    kPressing,
    kEstimating,
    kSaved,
    kRefused
  };
  Phase phase = Phase::kIdle;
  std::size_t finger = 0;  ///< which of the scene's
  bool by_touch = false;   ///< presses are touches that the wearer tells
  int press = 0;           ///< under way, from 1; 0: none yet
  int presses = 0;         ///< of so many
  std::string words;       ///< what happens now, one sentence
  double force = 0.0;      ///< N, as the sensor says
  double progress = 0.0;   ///< of presses or estimate, 0 to 1
  std::string message;     ///< what was found, or why nothing was saved

  /// The device is led by it, or will be.
  [[nodiscard]] bool is_under_way() const {
    return phase == Phase::kWaiting || phase == Phase::kPressing || phase == Phase::kEstimating;
  }
};

/// Something that happened to an object that moves by forces, see docs/files.md, events.csv.
struct LiveEvent {
  double time = 0.0;      ///< s, simulated
  std::string_view kind;  ///< one of kEventKinds
  std::string object;
  std::string other;  ///< an object's or a finger's name; empty: none
  double impulse = std::numeric_limits<double>::quiet_NaN();  ///< N s; NaN: none
};

/// The live loop as the viewer sees it. Called from the viewer's one thread; never blocks the loop.
class LiveFeed {
 public:
  virtual ~LiveFeed() = default;
  /// The scene now running. A new object whenever its generation grows.
  [[nodiscard]] virtual std::shared_ptr<const SceneDescription> description() = 0;
  /// Takes over the newest snapshot if there is one not yet taken.
  virtual bool refresh() = 0;
  [[nodiscard]] virtual const Snapshot& latest() const = 0;
  virtual void request(const LiveRequest& request) = 0;
  /// A hand that a headset sees, for the fingers that follow it.
  virtual void offer_hand(const XrHand& hand) = 0;
  /// Name of the scene that is being loaded, or begun anew, in place of the one described; empty:
  /// none is.
  [[nodiscard]] virtual std::string loading() { return {}; }
  /// What a person should know, one line, each once.
  [[nodiscard]] virtual std::optional<std::string> take_message() { return std::nullopt; }
  /// Of the scene that latest() is of, each once.
  [[nodiscard]] virtual std::optional<LiveEvent> take_event() { return std::nullopt; }
  /// Idle for ever where none is offered.
  [[nodiscard]] virtual const RegistrationState& registration() const {
    static const RegistrationState kIdle;
    return kIdle;
  }
  /// Idle for ever where none is offered.
  [[nodiscard]] virtual FitState fit() { return {}; }
};

}  // namespace softfinger
