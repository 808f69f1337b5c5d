#pragma once

namespace softfinger {

/// The live loop in wall time, as `softfinger run` has it: recorder, page, guard process, a board
/// on a pseudo-terminal and a tracker over the network, once without a fault and then with each
/// fault of live_faults.hpp, `seconds` each. Prints for each how late steps came and what they
/// took, what is missing from the recording, and where the device was.
///
/// A run holds its pace where it made 1000 steps a second within 0.1 % and 99 % of its steps were
/// less than a period late, all of them less than 0.1 s. False where a run does not though the one
/// without a fault does, or, where neither does since other programs keep the machine busy, is more
/// than twice as bad; where a recording lacks a step; where servos are not within 10 degrees of
/// their commands in the end, or not retracted within 4 s of it, or of a fault that stops the
/// device, and from then on; where people were not told what they must be; where what a line held
/// back brings more than 0.2 s of commands that differ; and where a fault did not come about. On a
/// virtual machine the least disturbed of several attempts counts, by what its host says alone;
/// where even that was disturbed, the pace is not judged, which is said.
[[nodiscard]] bool soak_live(double seconds);

}  // namespace softfinger
