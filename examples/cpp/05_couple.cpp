// The tip of a tool that nobody has hit: its receptance from the drawing, with and without a holder and a joint.
#include <robomill/base/units.hpp>
#include <robomill/coupling/assembly.hpp>

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <numbers>

using namespace robomill;

// Lines of 0.5 Hz.
double first_bending_hz(const coupling::Assembly& assembly) {
  const Eigen::VectorXd frequency_hz = Eigen::VectorXd::LinSpaced(7981, 10.0, 4000.0);
  const modal::FrfSet tip = coupling::tip_frfs(assembly, frequency_hz).frfs;
  Eigen::Index peak = 0;
  tip.find(modal::parse_frf_name("xx"))->receptance.cwiseAbs().maxCoeff(&peak);
  return frequency_hz(peak);
}

int main() {
  // A carbide shank, 12 mm across and 70 mm long.
  coupling::Segment shank{.length_m = 70 * units::mm,
                          .diameter_m = 12 * units::mm,
                          .youngs_modulus_pa = 580 * units::gpa,
                          .density_kg_per_m3 = 14400.0,
                          .poissons_ratio = 0.22,
                          .loss_factor = 0.005,
                          .beam = coupling::Beam::euler_bernoulli};
  // Without joint and holder it stands in a rigid wall: the cantilever of Euler and Bernoulli, (1.8751 / L)^2
  // sqrt(E I / rho A), where sqrt(I / A) = d / 4.
  const double wave = 1.875104069 / shank.length_m;
  const double closed_hz = wave * wave * std::sqrt(shank.youngs_modulus_pa / shank.density_kg_per_m3) *
                           shank.diameter_m / 4.0 / (2.0 * std::numbers::pi);
  coupling::Assembly assembly{.tool = {shank}, .joint = {}, .holder = {}};
  const double cantilever_hz = first_bending_hz(assembly);
  std::printf("cantilever, Euler-Bernoulli:   %.1f Hz (closed form %.1f Hz)\n", cantilever_hz, closed_hz);

  assembly.tool[0].beam = coupling::Beam::timoshenko;
  const double shear_hz = first_bending_hz(assembly);
  std::printf("with shear and rotary inertia: %.1f Hz\n", shear_hz);

  assembly.joint = coupling::Joint{.translational_stiffness_n_per_m = 1.5e8,
                                   .translational_damping_n_s_per_m = 200.0,
                                   .rotational_stiffness_n_m_per_rad = 3e4,
                                   .rotational_damping_n_m_s_per_rad = 0.05};
  assembly.holder.segments = {{.length_m = 60 * units::mm,
                               .diameter_m = 40 * units::mm,
                               .youngs_modulus_pa = 210 * units::gpa,
                               .density_kg_per_m3 = 7850.0,
                               .loss_factor = 0.01}};
  const double clamped_hz = first_bending_hz(assembly);
  std::printf("in a holder, elastic joint:    %.1f Hz\n", clamped_hz);
  return std::abs(cantilever_hz / closed_hz - 1.0) < 5e-4 && shear_hz < cantilever_hz && clamped_hz < shear_hz ? 0 : 1;
}
