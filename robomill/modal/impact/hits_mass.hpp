#pragma once
#include <string>
#include <vector>

#include "robomill/modal/frf.hpp"

namespace robomill::modal {

/// Takes the accelerometers' mass m out of receptances that were measured with all sensors of `sensors` mounted.
///
/// A sensor adds the force -m s² X_d at its degree of freedom d, so X = G (F - m s² X) and, with D the sensors' degrees
/// of freedom, G_m = G - m s² G_:D G_m,D:. Where forces were applied at the sensors' own degrees of freedom K ⊂ D, G_DK
/// = G_m,DK (I - m s² G_m,KK)^-1, and for every other force e: G_De = G_m,De + m s² G_DK G_m,Ke. For one sensor and one
/// force there, with s = iω: G = G_m / (1 + m ω² G_m). Loading through sensors outside K cannot be taken out: nothing
/// measured says how the structure answers to a force there.
/// @param frfs     receptances of all pairs of `sensors` with the forces that were applied; changed in place, with
/// their deviations
/// @param line_s   s of each line [1/s]
/// @return degrees of freedom whose loading remains (D without K)
/// Source: [Ewins2000] ch. 3 has the one-sensor case
std::vector<Dof> remove_mass(std::vector<Frf>& frfs, const std::vector<Dof>& sensors, const Eigen::VectorXcd& line_s,
                             double mass_kg);

}  // namespace robomill::modal
