#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace softfinger {

/// What people were told while the run was recorded: who stopped a device and when it was released,
/// what failed.
struct RecordedMessage {
  std::int64_t step = 0;     ///< the last one taken when it was told
  double time = 0.0;         ///< s, of the run
  double since_start = 0.0;  ///< s on the monotonic clock, also where the run's time stood still
  std::string text;          ///< one line
};

/// The recording's layout; a program reads the versions it knows.
inline constexpr std::int64_t kRecordingFormatVersion = 3;

/// What a recording says of its run as a whole.
struct RecordingInfo {
  /// A file the run was built from, with its content, so that a replay needs nothing else.
  struct File {
    std::filesystem::path path;  ///< absolute
    std::string content;
  };
  /// A mesh that objects of the scene were made of: too large to carry, so a replay needs it where
  /// it was, unchanged.
  struct Mesh {
    std::filesystem::path path;  ///< absolute
    std::uint64_t hash = 0;      ///< of its content, see MeshSource
  };
  struct Finger {
    std::string name;
    std::filesystem::path model;   ///< absolute
    std::filesystem::path device;  ///< absolute; empty: none
    std::string tracker;           ///< as given
    /// What was made of its poses before steps took them, for people: a replay takes what the rows
    /// hold. Empty: nothing, or it is not known.
    std::string poses;
    std::vector<std::string> configuration_names;  ///< with unit: pitch_deg, ...
    std::int64_t joints = 0;
    bool linear_joints = false;     ///< joints are lengths
    double device_rate = 0.0;       ///< Hz
    std::string servo_unit = "us";  ///< of set points; may be empty
    double servo_step = 0.25;       ///< set point of one step of the wire, in that unit
  };
  std::int64_t format_version = kRecordingFormatVersion;
  std::string program_version;
  std::string instruction_set;
  std::filesystem::path scene;   ///< absolute
  std::filesystem::path person;  ///< absolute; empty: none
  double simulation_rate = 0.0;  ///< Hz
  bool live = false;             ///< device ticks ran on their own thread
  bool with_state = false;       ///< nodes and samples of every step
  std::vector<Finger> fingers;
  /// Those that move by the forces on them.
  struct Object {
    std::int64_t object = 0;  ///< number in the scene
    std::string name;
    std::string joint_unit;  ///< of its joint's value, for people: mm, deg; empty: it has none
  };
  std::vector<Object> objects;
  /// Of all objects of the scene, where any moves.
  std::vector<std::string> object_names;
  std::vector<File> files;
  std::vector<Mesh> meshes;
};

}  // namespace softfinger
