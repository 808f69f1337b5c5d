#pragma once

#include <array>
#include <span>
#include <vector>

#include "softfinger/fem/elastic_material.hpp"
#include "softfinger/fem/element_kernels.hpp"
#include "softfinger/fem/relaxation.hpp"
#include "softfinger/fem/strain_limit.hpp"
#include "softfinger/geometry/pose.hpp"
#include "softfinger/geometry/tetrahedral_mesh.hpp"
#include "softfinger/threads/thread_team.hpp"

namespace softfinger {

/// Where the change of volume is taken: in each element, or averaged over patches of about four,
/// which does not lock near incompressibility.
enum class Dilatation { kElement, kPatch };

/// Soft solid of linear tetrahedra that follow the constitutive law, with strain limits; immutable.
/// Elements whose four nodes are all tied never deform and are left out.
class ElasticModel {
 public:
  /// What an evaluation leaves behind for the Hessian of the same positions.
  struct Work {
    std::vector<ElementDecomposition> decompositions;
    // Empty unless dilatation is averaged over patches.
    std::vector<ElementDilatation> dilatations;
    std::vector<double> pressures;  ///< per patch, Pa
    bool limited = true;            ///< false: as if there were no strain limits
    // Of the step under way, see begin_step().
    double factor = 1.0;
    std::vector<ElementStress> memory;  ///< per group; empty for elastic solids
    /// Of consecutive groups, where evaluations are worth sharing among threads; else empty.
    struct Slice {
      double energy = 0.0;            ///< J
      std::vector<Vector3> gradient;  ///< per node, N
    };
    std::vector<Slice> slices;
  };
  /// Elements that share their change of volume: energy 1/2 lambda V (mean dilatation)^2.
  struct Patch {
    double volume = 0.0;  ///< V, m^3
    double lambda = 0.0;  ///< Pa
    std::vector<int> nodes;
  };

  /// `element_material[t]` indexes `materials`, -1 leaves tetrahedron t out; `tied[n]` says that
  /// node n moves with the bone.
  ElasticModel(const TetrahedralMesh& mesh, std::span<const ElasticMaterial> materials,
               std::span<const int> element_material, const std::vector<bool>& tied,
               const StrainLimit& limit, Dilatation dilatation, Relaxation relaxation,
               InstructionSet set);

  /// Work with every decomposition at the identity: the start of a reproducible sequence.
  [[nodiscard]] Work make_work() const;
  void reset(Work& work) const;

  [[nodiscard]] StressHistory make_history() const {
    return softfinger::make_history(relaxation_, groups_.size());
  }
  /// Prepares evaluations of a step of `time_step` (s) from `history`. 0: at once, without a past.
  void begin_step(const StressHistory& history, double time_step, Work& work) const;
  /// Prepares evaluations of what remains after all stress that can relax has done so.
  void begin_relaxed(Work& work) const;
  /// Adds the step that ended at the positions last evaluated to `history`.
  void end_step(const Work& work, double time_step, StressHistory& history) const;

  /// Returns the strain energy at `positions` (n nodes, m), J; adds its gradient to `gradient`, N.
  /// With a team, where it is worth sharing, the same bits in less time.
  double energy_gradient(std::span<const Vector3> positions, Work& work,
                         std::span<Vector3> gradient, ThreadTeam* team = nullptr) const;
  /// Element Hessians of group `group` at the positions last evaluated with `work`.
  void hessian(std::size_t group, const Work& work, bool projected,
               ElementHessians& hessians) const;
  /// True where the group has a node that moves with the rigid body.
  [[nodiscard]] bool touches_body(std::size_t group) const { return group >= first_body_group_; }
  /// What concerns the body in a group's Hessian; see ElementKernels::body_hessian.
  void body_hessian(std::size_t group, std::span<const Vector3> lever_arms,
                    const ElementHessians& hessians, ElementBodyHessians& rows,
                    BodyHessianSums& sums) const;

  /// Deformed over rest volume of all soft elements together.
  [[nodiscard]] double volume_ratio(std::span<const Vector3> positions) const;
  /// Least and greatest principal stretch over the soft elements, as last evaluated.
  struct Stretches {
    double min = 1.0, max = 1.0;
  };
  [[nodiscard]] Stretches stretches(const Work& work) const;

  [[nodiscard]] std::span<const Patch> patches() const { return patches_; }
  /// -1: in none. Empty without patches.
  [[nodiscard]] std::span<const int> patch_of_tetrahedron() const { return patch_of_tetrahedron_; }
  /// Derivative of V times the mean dilatation of each patch by its nodes, m^2, patch after patch
  /// in the order of Patch::nodes, at the positions last evaluated with `work`.
  void patch_gradients(const Work& work, std::span<Vector3> gradients) const;

  /// Whether there is so much to do in an evaluation that a second thread pays.
  [[nodiscard]] bool is_worth_sharing() const;

  [[nodiscard]] std::span<const ElementGroup> groups() const { return groups_; }
  [[nodiscard]] std::size_t elements() const { return elements_; }
  /// Lumped nodal masses, kg, elements with only tied nodes included.
  [[nodiscard]] std::span<const double> masses() const { return masses_; }

 private:
  /// Place of an element in its patch; patch -1: none.
  struct Membership {
    int patch = -1;
    int first = 0;          ///< of the patch's nodes in the list of all patches' nodes
    std::array<int, 4> at;  ///< the element's nodes in the patch's
  };
  void add_element(const TetrahedralMesh& mesh, std::size_t e, const ElasticMaterial& material,
                   const std::vector<bool>& tied, int patch);
  void number_patch_nodes();
  /// Energy of the groups from `begin` to before `end`; adds their gradient.
  double evaluate_groups(std::size_t begin, std::size_t end, std::span<const Vector3> positions,
                         Work& work, std::span<Vector3> gradient) const;
  [[nodiscard]] ElementViscosity viscosity(const Work& work, std::size_t group) const {
    return {work.factor, work.memory.empty() ? nullptr : &work.memory[group]};
  }
  /// Pressure of each lane's patch times `scale`; zero without patches.
  void read_pressures(const Work& work, std::size_t group, double scale,
                      double (&pressures)[kLanes]) const;
  void add_patch_pressures(Work& work, std::span<Vector3> gradient, double& energy) const;

  std::vector<ElementGroup> groups_;
  std::size_t elements_ = 0;
  std::size_t first_body_group_ = 0;
  std::vector<Patch> patches_;
  std::vector<int> patch_of_tetrahedron_;
  std::vector<Membership> memberships_;  ///< per element; empty without patches
  std::vector<double> masses_;
  Relaxation relaxation_;
  StrainLimit limit_;
  const ElementKernels* kernels_ = nullptr;
};

}  // namespace softfinger
