#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "softfinger/base/name_table.hpp"
#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// How the fingertip rests on a horizontal table.
enum class Posture { kPad, kLeftSide, kRightSide, kTip };

struct PostureRow {
  Posture value;
  std::string_view name;      ///< in messages and on the wire
  std::string_view words;     ///< what a person does, within a line of the terminal
  std::string_view sentence;  ///< the same on the page
};
inline constexpr std::array<PostureRow, 4> kPostures{{
    {Posture::kPad, "pad", "rest the pad flat on the table", "Rest the pad flat on the table."},
    {Posture::kLeftSide, "left side",
     "roll the finger onto its left side, as seen from above the nail",
     "Roll the finger onto its left side, as seen from above the nail."},
    {Posture::kRightSide, "right side", "roll it onto its right side",
     "Roll it over onto its right side."},
    {Posture::kTip, "tip", "stand it on its tip, straight up", "Stand it on its tip, straight up."},
}};

/// "pad", "left side", "right side", "tip".
[[nodiscard]] constexpr std::string_view name_of(Posture posture) {
  return row_of(kPostures, posture).name;
}
/// The table's upward direction in F.
[[nodiscard]] Vector3 up_in_finger(Posture posture);

/// What a tracked body says of a posture. Where on the table, and which way round, does not matter.
struct PostureCapture {
  Posture posture = Posture::kPad;
  Vector3 up_Body = Vector3::UnitZ();  ///< z of W in the body's frame, unit
  double height = 0.0;                 ///< of the body's origin in W, m
};

struct Registration {
  Pose X_BodyFt;
  double scale = 1.0;            ///< of the finger; 1 where its size was known
  double table_height = 0.0;     ///< m in W
  double turn_residual = 0.0;    ///< largest angle of a posture from what all say, rad
  double height_residual = 0.0;  ///< largest distance of the skin from the table, m
};

/// Where a body sits on the finger, from at least one capture of each posture.
///
/// The rotation is the one that takes the upward directions of the postures in F best to those seen
/// in the body, in the sense of least squares (Wahba, SIAM Review 7(3), 1965, problem 65-1; solved
/// as Kabsch, Acta Crystallographica A32, 1976). The skin `skin_F` (m, at rest) touches the table
/// where it reaches farthest down, at s: up . p = table_height + scale s - height, one linear
/// equation a capture for p, the origin of F in the body, and either the table's height or the
/// scale, whichever is not known. `table_height` (m in W) empty: the size of `skin_F` is the
/// person's; given: `size_known` says whether it is.
///
/// Throws InputError, one line that names the posture and says what to do: a posture without a
/// capture, directions off by more than 20 degrees, the skin more than 3 mm off the table, a
/// scaled breadth out of 8 to 30 mm, the finger more than 300 mm from the body.
[[nodiscard]] Registration register_finger(std::span<const PostureCapture> captures,
                                           std::span<const Vector3> skin_F,
                                           std::optional<double> table_height, bool size_known);

}  // namespace softfinger
