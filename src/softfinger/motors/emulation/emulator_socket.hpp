#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "softfinger/motors/emulation/bus_emulator.hpp"
#include "softfinger/motors/emulation/emulator_port.hpp"

namespace softfinger {

/// An emulated bus at a socket on loopback, at any free port, in wall time, with a thread of its
/// own: UDP datagrams, or one TCP client after another.
class EmulatorSocket : public EmulatorPort {
 public:
  enum class Kind { kUdp, kTcp };

  /// `emulator` must outlive this. Throws OperationError when the system gives no socket.
  EmulatorSocket(BusEmulator& emulator, Kind kind);
  ~EmulatorSocket() override;

  /// "127.0.0.1:PORT".
  [[nodiscard]] const std::string& port() const override { return port_; }
  /// Hangs up and listens no more, for good.
  void vanish();

 private:
  void serve();
  /// Bytes of the client's, or a datagram; false: the client is gone.
  bool take_bytes(int from);

  BusEmulator& emulator_;
  bool datagrams_;
  std::string port_;
  int socket_ = -1;
  int client_ = -1;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace softfinger
