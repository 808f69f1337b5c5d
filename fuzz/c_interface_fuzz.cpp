// Calls of the C interface as a host program that is wrong might make them: in any order, with any
// sizes, numbers and handles, of one finger, of several that hold something between them, and of a
// device. What it is told is a status it knows; a message is one line.
#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "../tests/support/folders.hpp"
#include "scratch_file.hpp"
#include "softfinger/softfinger.h"

namespace {

/// What is left of the input, value by value; zeros when it is used up.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  template <typename T>
  T take() {
    T value{};
    const std::size_t size = std::min(sizeof value, left_);
    std::memcpy(&value, data_, size);
    data_ += size;
    left_ -= size;
    return value;
  }
  [[nodiscard]] bool empty() const { return left_ == 0; }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

void expect(bool holds) {
  if (!holds) __builtin_trap();
}

bool is_line(std::string_view text) { return text.find('\n') == std::string_view::npos; }

void expect_known(sf_status status) {
  expect(status == SF_DONE || status == SF_FAILED || status == SF_BAD_INPUT);
}

void expect_told(sf_status status, const sf_rendering* rendering) {
  expect_known(status);
  char line[256];
  expect(sf_rendering_message(rendering, line, sizeof line) == SF_DONE);
  const std::string_view text = line;
  expect(is_line(text) && (status == SF_DONE || !text.empty()));
}

/// Half of the numbers are near what a finger does.
double number(Bytes& bytes) {
  const auto word = bytes.take<std::int16_t>();
  return (word & 1) != 0 ? bytes.take<double>() : word * 1e-6;
}

/// The right size, or any.
template <typename Struct>
std::uint32_t sized(Bytes& bytes) {
  const auto byte = bytes.take<std::uint8_t>();
  return (byte & 3) != 0 ? sizeof(Struct) : bytes.take<std::uint32_t>();
}

/// Mostly where a finger touches.
sf_pose pose_of(Bytes& bytes, std::uint32_t size) {
  sf_pose pose = {size, {0.0, 0.0, 0.009}, {1.0, 0.0, 0.0, 0.0}};
  const auto what = bytes.take<std::uint8_t>();
  if ((what & 1) != 0) {
    for (double& p : pose.position_m) p = number(bytes);
  }
  if ((what & 2) != 0) {
    for (double& q : pose.quaternion_wxyz) q = number(bytes);
  }
  return pose;
}

/// Two fingers and a ball that rolls between them; no device.
constexpr std::string_view kScene = R"([[finger]]
name = "index"
model = "SOURCE/fingers/index.toml"
tracker = "page"
[[finger]]
name = "thumb"
model = "SOURCE/fingers/index.toml"
tracker = "page"
[[object]]
name = "table"
shape = "plane"
[[object]]
name = "ball"
shape = "sphere"
radius_mm = 5.0
position_mm = [0.0, 0.0, 5.0]
motion = "dynamic"
mass_g = 3.0
)";

/// A rendering of all fingers of a scene, and what its calls read.
class Several {
 public:
  Several() {
    std::string scene(kScene);
    for (std::size_t at; (at = scene.find("SOURCE")) != std::string::npos;) {
      scene.replace(at, 6, softfinger::source_folder());
    }
    const softfinger::ScratchFile file("several.toml");
    file.write({reinterpret_cast<const std::uint8_t*>(scene.data()), scene.size()});
    sf_options options = {};
    options.size = sizeof options;
    options.all_fingers = 1;
    expect(sf_rendering_create(file.path().c_str(), &options, &handle_, nullptr, 0) == SF_DONE);
  }

  void call(Bytes& bytes) { expect_told(call(bytes.take<std::uint8_t>() % 10, bytes), handle_); }

 private:
  sf_status call(int which, Bytes& bytes) {
    const std::size_t room = bytes.take<std::uint8_t>() % 9;
    std::array<double, 27> numbers;
    std::array<std::uint32_t, 27> corners;
    std::array<char, 9> text;
    std::size_t count = 0;
    const std::size_t index = bytes.take<std::uint8_t>() % 4;
    switch (which) {
      case 0:
      case 1:
        return step(bytes);
      case 2:
        return sf_rendering_select(handle_, index);
      case 3: {
        sf_object object = {sized<sf_object>(bytes), 0, 0, 0, 0.0, {}, {}};
        return sf_rendering_object(handle_, index, &object);
      }
      case 4:
        (void)sf_rendering_object_triangles(handle_, index, corners.data(), room, &count);
        (void)sf_rendering_triangles(handle_, corners.data(), room, &count);
        return sf_rendering_object_positions(handle_, index, numbers.data(), room, &count);
      case 5: {
        sf_event event = {sized<sf_event>(bytes), 0, 0.0, 0.0, 0, 0, 0, 0};
        return sf_rendering_take_event(handle_, &event);
      }
      case 6: {
        sf_pose tracked = {sized<sf_pose>(bytes), {}, {}},
                simulated = {sized<sf_pose>(bytes), {}, {}};
        (void)sf_rendering_object_pose(handle_, index, &tracked);
        return sf_rendering_poses(handle_, &tracked, index == 0 ? nullptr : &simulated);
      }
      case 7:
        (void)sf_rendering_finger_name(handle_, index, text.data(), room, &count);
        (void)sf_rendering_configuration_name(handle_, index, text.data(), room, nullptr);
        return sf_rendering_take_message(handle_, text.data(), room, &count);
      case 8: {
        sf_info info = {};
        info.size = sized<sf_info>(bytes);
        (void)sf_rendering_pressures(handle_, numbers.data(), room, &count);
        return sf_rendering_info(handle_, &info);
      }
      default: {
        sf_command command;
        command.size = sized<sf_command>(bytes);
        return sf_rendering_command(handle_, &command);
      }
    }
  }

  sf_status step(Bytes& bytes) {
    const std::uint32_t size = sized<sf_pose>(bytes);
    // As large as a size that is taken may make them.
    std::array<sf_pose, 32> poses{};
    for (std::size_t i = 0; i < 2; ++i) poses[i] = pose_of(bytes, i == 0 ? size : 0);
    poses[0].position_m[1] += 0.02;
    const std::array<std::int32_t, 3> tracked = {bytes.take<std::uint8_t>(), 1, 1};
    const auto what = bytes.take<std::uint8_t>();
    const std::size_t count = (what & 3) != 0 ? 2 : what >> 2;
    if (what == 0xff) time_ = bytes.take<double>();
    time_ += (what % 4) * 1e-3;
    return sf_rendering_step_fingers(handle_, what == 4 ? nullptr : poses.data(),
                                     (what & 8) != 0 ? tracked.data() : nullptr, count, time_);
  }

  sf_rendering* handle_ = nullptr;
  double time_ = 0.0;
};

/// A device of three joints and what is asked of it.
class Drive {
 public:
  Drive() {
    expect(sf_device_create((softfinger::source_folder() + "/devices/thimble-3rrs.toml").c_str(),
                            &handle_, nullptr, 0) == SF_DONE);
  }

  void call(Bytes& bytes) {
    expect_known(call(bytes.take<std::uint8_t>() % 5, bytes));
    char line[256];
    expect(sf_device_message(handle_, line, sizeof line) == SF_DONE && is_line(line));
  }

 private:
  sf_status call(int which, Bytes& bytes) {
    std::array<double, 4> given{}, found{};
    for (double& value : given) value = number(bytes);
    const auto counts = bytes.take<std::uint8_t>();
    const std::size_t some = (counts & 4) != 0 ? 3 : counts % 4, room = (counts & 8) != 0 ? 3 : 2;
    switch (which) {
      case 0: {
        std::int32_t closes = 0, reachable = 0;
        return sf_device_solve(handle_, given.data(), some, found.data(), room, &closes,
                               &reachable);
      }
      case 1:
        return sf_device_pose(handle_, given.data(), some, found.data(), room);
      case 2: {
        std::array<char, 9> text;
        std::size_t count = 0;
        (void)sf_device_component(handle_, some, text.data(), room, given.data());
        return sf_device_show(handle_, text.data(), counts % 10, &count);
      }
      case 3: {
        sf_device_info info = {sized<sf_device_info>(bytes), 0, 0, 0};
        (void)sf_device_home(handle_, found.data(), some);
        return sf_device_describe(handle_, &info);
      }
      default:
        return match(bytes, given);
    }
  }

  sf_status match(Bytes& bytes, std::span<const double, 4> given) {
    constexpr std::uint32_t kCount = 5;
    std::array<double, 3 * kCount> points;
    std::array<double, kCount> areas, gaps;
    std::array<std::uint8_t, kCount> touching;
    for (double& value : points) value = number(bytes);
    for (double& value : areas) value = number(bytes);
    for (double& value : gaps) value = number(bytes);
    for (std::uint8_t& value : touching) value = bytes.take<std::uint8_t>();
    const auto what = bytes.take<std::uint8_t>();
    sf_points asked = {};
    asked.size = sized<sf_points>(bytes);
    asked.count = (what & 1) != 0 ? kCount : what % (kCount + 1);
    asked.points_F_m = what == 2 ? nullptr : points.data();
    asked.in_contact = what == 4 ? nullptr : touching.data();
    asked.areas_m2 = (what & 8) != 0 ? areas.data() : nullptr;
    asked.gaps_m = (what & 16) != 0 ? gaps.data() : nullptr;
    asked.separation_m = (what & 32) != 0 ? given[0] : 0.0;
    asked.limits = what >> 6;
    sf_match found;
    found.size = sized<sf_match>(bytes);
    return sf_device_match(handle_, &asked, &found);
  }

  sf_device* handle_ = nullptr;
};

/// Calls that make something of words and numbers: all of it is refused here, or ends at once.
void make(Bytes& bytes) {
  std::array<char, 12> word{};
  for (std::size_t i = 0; i + 1 < word.size(); ++i) word[i] = bytes.take<char>();
  std::array<char, 64> error, text;
  std::size_t count = 0;
  expect_known(sf_shipped_file(bytes.take<std::uint8_t>() % 2 == 0 ? "device" : word.data(),
                               word.data(), text.data(), bytes.take<std::uint8_t>() % 65, &count,
                               error.data(), bytes.take<std::uint8_t>() % 65));
  const std::int32_t stop = 1;
  sf_press_options press = {};
  press.size = sized<sf_press_options>(bytes);
  press.rows = bytes.take<std::int32_t>();
  press.depth_m = bytes.take<double>();
  press.sphere_radius_m = number(bytes);
  press.hold_s = number(bytes);
  press.stop = &stop;
  sf_table* table = nullptr;
  // No finger of that name: what is wrong with the options is told, or that.
  const sf_status status = sf_press("no-such-finger", &press, &table, error.data(), error.size());
  expect(status == SF_BAD_INPUT && table == nullptr && is_line(error.data()) && error[0] != '\0');
  char line[32];
  expect_known(
      sf_scene_finger(word.data(), 0, line, sizeof line, &count, error.data(), error.size()));
}

class Host {
 public:
  Host() {
    expect(create() == SF_DONE);
    ended_ = rendering_;
    sf_rendering_destroy(ended_);
    expect(create() == SF_DONE);
  }

  void call(Bytes& bytes) {
    const auto which = bytes.take<std::uint8_t>();
    sf_rendering* handle = which >= 0xf0 ? ended_ : which >= 0xe0 ? nullptr : rendering_;
    expect_told(call(which % 10, handle, bytes), handle);
  }

 private:
  sf_status create() {
    return sf_rendering_create((softfinger::source_folder() + "/scenes/plane.toml").c_str(),
                               nullptr, &rendering_, nullptr, 0);
  }

  sf_status call(int which, sf_rendering* handle, Bytes& bytes) {
    switch (which) {
      case 0:
      case 1:
        return step(handle, bytes);
      case 2:
        return step_matrix(handle, bytes);
      case 3:
        return sf_rendering_lost(handle, next_time(bytes), nullptr);
      case 4:
        return sf_rendering_stop(handle);
      case 5:
        return sf_rendering_release(handle);
      case 6: {
        sf_contact contact = {bytes.take<std::uint32_t>()};
        return sf_rendering_contact(handle, &contact);
      }
      case 7: {
        double positions[30];
        std::size_t count = 0;
        return sf_rendering_positions(handle, positions, bytes.take<std::uint8_t>() % 11, &count);
      }
      case 8: {
        char name[8];
        return sf_rendering_object_name(handle, bytes.take<std::uint32_t>(), name,
                                        bytes.take<std::uint8_t>() % 9, nullptr);
      }
      default:
        return pose_to_engines(bytes);
    }
  }

  sf_status step(sf_rendering* handle, Bytes& bytes) {
    sf_pose X_WFt = {sized<sf_pose>(bytes), {}, {1.0, 0.0, 0.0, 0.0}};
    for (double& p : X_WFt.position_m) p = number(bytes);
    if ((bytes.take<std::uint8_t>() & 1) != 0) {
      for (double& q : X_WFt.quaternion_wxyz) q = number(bytes);
    }
    sf_command command;
    command.size = sized<sf_command>(bytes);
    return sf_rendering_step(handle, &X_WFt, next_time(bytes), &command);
  }

  sf_status step_matrix(sf_rendering* handle, Bytes& bytes) {
    double matrix[16] = {1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0,
                         0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0};
    for (int changes = bytes.take<std::uint8_t>() % 4; changes > 0; --changes) {
      matrix[bytes.take<std::uint8_t>() % 16] = number(bytes);
    }
    return sf_rendering_step_matrix(handle, matrix, next_time(bytes), nullptr);
  }

  static sf_status pose_to_engines(Bytes& bytes) {
    sf_pose pose = {sized<sf_pose>(bytes), {}, {}};
    for (double& p : pose.position_m) p = number(bytes);
    sf_unity_pose unity = {sized<sf_unity_pose>(bytes), {}, {}};
    return sf_pose_to_unity(&pose, &unity);
  }

  /// Mostly a few steps on; else back, or any number.
  double next_time(Bytes& bytes) {
    const auto byte = bytes.take<std::uint8_t>();
    if (byte == 0xff) return bytes.take<double>() < time_ ? time_ - 1.0 : bytes.take<double>();
    time_ += (byte % 8) * 1e-3;
    return time_;
  }

  sf_rendering* rendering_ = nullptr;
  sf_rendering* ended_ = nullptr;
  double time_ = 0.0;
};

}  // namespace

extern "C" int fuzz_c_interface(const std::uint8_t* data, std::size_t size) {
  static Host host;
  static Several several;
  static Drive drive;
  Bytes bytes(data, size);
  // What the first byte of an input says; the calls of one finger have the most to them.
  const auto whom = bytes.take<std::uint8_t>();
  for (int calls = 0; calls < 20 && !bytes.empty(); ++calls) {
    if (whom >= 0xf8) {
      make(bytes);
    } else if (whom >= 0xe0) {
      drive.call(bytes);
    } else if (whom >= 0xb0) {
      several.call(bytes);
    } else {
      host.call(bytes);
    }
  }
  return 0;
}
