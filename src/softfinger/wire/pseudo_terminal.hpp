#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace softfinger {

/// A serial line to nowhere: whoever opens name() finds a tty, and this is its far end, which never
/// blocks. One thread at a time.
class PseudoTerminal {
 public:
  /// Throws OperationError where the system gives none.
  PseudoTerminal();
  ~PseudoTerminal();
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  /// To open, e.g. /dev/pts/3.
  [[nodiscard]] const std::string& name() const { return name_; }
  /// What nobody reads is lost, as on a serial line.
  void write(std::span<const std::uint8_t> bytes);
  /// What has arrived; returns how many bytes.
  std::size_t read(std::span<std::uint8_t> out);
  /// Waits until something arrives, or for so long.
  void wait(int milliseconds) const;
  /// Unplugs it: it is gone for whoever has it open. For good.
  void vanish();

 private:
  std::string name_;
  int near_ = -1;  ///< this end
  int far_ =
      -1;  ///< held open so that the line outlives its users, and its number is not another's
};

}  // namespace softfinger
