#pragma once

#include <hdf5.h>

#include <utility>

namespace softfinger {

/// What is thrown where HDF5 refuses.
struct Hdf5Failure {};

inline void hdf5_check(herr_t status) {
  if (status < 0) throw Hdf5Failure{};
}

/// Owns an object of HDF5 and closes it with the call given.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close_it)(hid_t)) : id_(id), close_(close_it) {
    if (id < 0) throw Hdf5Failure{};
  }
  Hdf5Handle(Hdf5Handle&& other) noexcept
      : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(Hdf5Handle&&) = delete;

  [[nodiscard]] hid_t id() const { return id_; }
  void close() { hdf5_check(close_(std::exchange(id_, -1))); }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// How objects of a class come into being: without the time, so that the same recording gives the
/// same bytes.
inline Hdf5Handle hdf5_creation(hid_t kind) {
  Hdf5Handle creation(H5Pcreate(kind), H5Pclose);
  hdf5_check(H5Pset_obj_track_times(creation.id(), 0));
  return creation;
}

}  // namespace softfinger
