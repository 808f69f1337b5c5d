#pragma once

#include <cstdint>
#include <filesystem>

#include "softfinger/person/person_registration.hpp"
#include "softfinger/session/live_feed.hpp"
#include "softfinger/session/run_setup.hpp"
#include "softfinger/tracking/registration/registration_procedure.hpp"

namespace softfinger {

/// A registration that the page asked for: follows one finger's tracked body in the snapshots of a
/// run and writes the person's file when all postures were held. Ends with the run. One thread, not
/// the loop's.
class LiveRegistration {
 public:
  /// Begins anew; false, and nothing happens, where this finger cannot be registered. `setup` is
  /// that of the run of this generation.
  bool begin(const LiveRequest& request, const RunSetup& setup, std::uint64_t generation);
  void cancel();
  /// True where the person's file was written just now.
  bool take(const Snapshot& snapshot);
  [[nodiscard]] const RegistrationState& state() const { return state_; }

 private:
  void tell_wanted();
  bool conclude();

  std::filesystem::path person_;
  std::uint64_t generation_ = 0;
  RegistrationTask task_;
  Pose X_FtBody_;
  RegistrationProcedure procedure_;
  RegistrationState state_;
};

}  // namespace softfinger
