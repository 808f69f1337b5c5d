#pragma once

#include <vector>

namespace softfinger {

/// E as a function of one pin's height, the others' held: a sum of pieces of parabolas, and where a
/// sample passes beside the pin's edge, of the squared lack of its distance to that edge.
class PinProfile {
 public:
  /// `capacity`: most samples one pin can see.
  explicit PinProfile(int capacity);

  void clear();
  /// weight min(ceiling, offset2 + (z - h)^2): a sample in contact, offset2 its squared distance
  /// aside and `ceiling` its squared distance to the other pins. m, m^2.
  void add_contact(double weight, double z, double offset2, double ceiling);
  /// weight max(floor, margin - distance)^2 for a sample that must keep `margin` from the pin:
  /// distance as pin_distance(beyond, z - h), `floor` what it lacks to the other pins, >= 0. m.
  void add_clear(double weight, double z, double beyond, double margin, double floor);

  /// Height in [low, high] of the least value; of several the one nearest to `home`.
  [[nodiscard]] double minimise(double low, double high, double home);

 private:
  /// The slope's change at a height: what a piece adds from there on. Value is
  /// square h^2 - 2 linear h + constant, and the rim's pieces.
  struct Event {
    double height;
    double square, linear, constant;
    int rim;  ///< +k begins, -k ends rim piece k - 1; 0: none
  };
  struct Rim {
    double weight, z, beyond, margin;
    [[nodiscard]] double value(double h) const;
    [[nodiscard]] double slope(double h) const;
  };

  void add_event(double height, double square, double linear, double constant, int rim = 0);
  [[nodiscard]] double inner_minimum(double from, double to) const;
  [[nodiscard]] double value(double h) const;

  std::vector<Event> events_;
  std::vector<Rim> rims_;
  std::vector<int> open_rims_;
  // At the present interval of the sweep.
  double square_ = 0.0, linear_ = 0.0, constant_ = 0.0;
};

}  // namespace softfinger
