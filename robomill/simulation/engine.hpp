#pragma once
#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <vector>

#include "robomill/simulation/cut_model.hpp"
#include "robomill/simulation/modal_step.hpp"
#include "robomill/simulation/surface.hpp"

namespace robomill::simulation::detail {

/// What of the cut takes part.
enum class Physics {
  full,         ///< loss of contact, everything left by earlier teeth
  linear,       ///< as if the chip could have negative thickness; which tooth misses follows from feed and runout alone
  forced,       ///< of the linear cut, chips as a rigid cutter would cut them: nothing regenerates
  perturbation  ///< of the linear cut: without feed and edge forces
};

/// Where an edge passed the finished wall: outward = out + slope (x - x_0) - bend (x - x_0)².
struct WallPass {
  int ring = 0;
  double x_m = 0.0, out_m = 0.0, slope = 0.0, bend_per_m = 0.0;
};

/// One cut advanced step by step. Nothing is allocated after construction.
template <int D>
class Engine {
 public:
  /// model must outlive this; profiles in it may change meanwhile from the end of the last step on.
  Engine(const CutModel& model, const modal::TipModes& structure, Physics physics);

  void step();

  [[nodiscard]] double step_s() const { return step_s_; }
  [[nodiscard]] double time_s() const { return static_cast<double>(steps_) * step_s_; }
  /// At the end of the last step, just before what happens there [m].
  [[nodiscard]] const Vector<D>& displacement() const { return q_; }
  /// Mean over the last step [N], on the tool.
  [[nodiscard]] const Vector<D>& mean_force() const { return mean_force_; }
  /// Steps after which an edge that should have been in the cut was out of it.
  [[nodiscard]] std::int64_t steps_without_contact() const { return without_contact_; }
  [[nodiscard]] std::size_t modes() const { return modes_.size(); }
  /// Starts a mode from this state.
  void set_mode(std::size_t mode, std::complex<double> value);
  /// Of the whole motion; a perturbation may be of any size.
  void scale(double factor);

  /// Passes of the wall at this angle (0 or π) are kept, the last `capacity` > 0 of them.
  void watch_wall(double angle_rad, std::size_t capacity);
  /// In the order made; of the wall that was watched first, second.
  [[nodiscard]] std::vector<WallPass> wall_passes(std::size_t wall) const;

 private:
  /// A chip c(q) = n·q + gap cut at the angle with this sine and cosine.
  struct Chip {
    double sine = 0.0, cosine = 1.0, gap_m = 0.0;
    bool cuts = false;
  };
  /// An element between entry and exit during a part of the step, [mid - share/2, mid + share/2].
  struct Touch {
    const Element* element = nullptr;
    const Ring* ring = nullptr;
    bool from_start = false, to_end = false;
    double share = 1.0, mid = 0.5;
    Chip start, end, middle;
    [[nodiscard]] bool whole() const { return from_start && to_end; }
  };
  struct Near {
    int element = 0;
    double position_a = 0.0, position_b = 0.0;  ///< in nodes of its ring
    double sine_a = 0.0, cosine_a = 1.0, sine_b = 0.0, cosine_b = 1.0;
  };
  struct Pending {
    int node = -1;
    bool cuts = false;
    Node value;
  };
  struct WatchedWall {
    double angle_rad = 0.0;
    std::size_t capacity = 0, next = 0;
    std::vector<WallPass> passes;
  };
  /// F = K q + f.
  struct Affine {
    Square<D> k = Square<D>::Zero();
    Vector<D> f = Vector<D>::Zero();
  };

  [[nodiscard]] const Ring& ring_of(const Element& element) const {
    return model_.rings[static_cast<std::size_t>(element.ring)];
  }
  [[nodiscard]] Vector<D> normal(const Ring& ring, double sine, double cosine) const;
  [[nodiscard]] Chip chip(const Element& element, double position, double sine, double cosine, double feed_m) const;
  void collect();
  void touch(const Near& near);
  void add(const Touch& touch, const Chip& chip, double width, Affine& sum) const;
  void add_damping(const Touch& touch, Square<D>& sum) const;
  bool update_contact(const Touch& touch, Chip& chip, const Vector<D>& q) const;
  void solve_start();
  void solve_step();
  struct Assembly;
  void assemble(Assembly& assembly);
  void leave_surface();
  void leave_node(const Near& near, int node);
  void leave_start();
  void set_depth(double time_s);
  [[nodiscard]] double position(const Element& element) const;
  void pass_wall(const Near& near, WatchedWall& wall);

  const CutModel& model_;
  Physics physics_;
  double step_s_;
  ModalStep<D> modes_;
  Surface<D> surface_;
  std::vector<Element> elements_;
  Square<D> compliance_;
  bool compliant_ = false, damped_ = false;
  std::int64_t steps_ = 0, without_contact_ = 0;
  double angle_a_ = 0.0, angle_b_ = 0.0, feed_a_ = 0.0, feed_b_ = 0.0, damping_ = 0.0;
  Vector<D> modal_a_ = Vector<D>::Zero(), modal_b_ = Vector<D>::Zero();  ///< of the modes alone
  Vector<D> q_a_ = Vector<D>::Zero(), q_ = Vector<D>::Zero(), mean_force_ = Vector<D>::Zero();
  std::vector<Near> near_;
  std::vector<Touch> touches_;
  std::vector<Pending> pending_;
  std::vector<WatchedWall> walls_;
};

extern template class Engine<2>;
extern template class Engine<3>;

}  // namespace robomill::simulation::detail
