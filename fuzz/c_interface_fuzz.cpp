// Calls of the C interface as a host program that is wrong might make them: in any order, with any
// sizes, numbers and handles. What it is told is a status it knows; a message is one line.
#include <algorithm>
#include <cstring>
#include <string_view>

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

void expect_told(sf_status status, const sf_rendering* rendering) {
  expect(status == SF_DONE || status == SF_FAILED || status == SF_BAD_INPUT);
  char line[256];
  expect(sf_rendering_message(rendering, line, sizeof line) == SF_DONE);
  const std::string_view text = line;
  expect(text.find('\n') == std::string_view::npos && (status == SF_DONE || !text.empty()));
}

/// Half of the numbers are near what a finger does.
double number(Bytes& bytes) {
  const auto word = bytes.take<std::int16_t>();
  return (word & 1) != 0 ? bytes.take<double>() : word * 1e-6;
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
    return sf_rendering_create(SOFTFINGER_SOURCE_DIR "/scenes/plane.toml", nullptr, &rendering_,
                               nullptr, 0);
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

  template <typename Struct>
  static std::uint32_t sized(Bytes& bytes) {
    const auto byte = bytes.take<std::uint8_t>();
    return (byte & 3) != 0 ? sizeof(Struct) : bytes.take<std::uint32_t>();
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

extern "C" int read_c_interface(const std::uint8_t* data, std::size_t size) {
  static Host host;
  Bytes bytes(data, size);
  for (int calls = 0; calls < 20 && !bytes.empty(); ++calls) host.call(bytes);
  return 0;
}
