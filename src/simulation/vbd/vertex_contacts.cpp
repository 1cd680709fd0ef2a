#include "simulation/vbd/vertex_contacts.h"

namespace selvage {

void VertexContacts::renew(const IncrementalPotential& potential) {
  terms_ = potential.terms();
  first_.assign(1, 0);
  items_.clear();
  for (const Index v : colours_.vertices) {
    if (potential.is_free(v))
      for (const Index t : potential.terms_of(v)) {
        const OffsetTerm& term = terms_[t];
        const int place = term.place_of(v);
        const double weight = term.weights[place];
        if (weight == 0) continue;
        double together = std::abs(weight);
        for (int j = 0; j < term.count; ++j) {
          const Index other = term.vertices[j];
          if (j != place && colours_.of_vertex[other] == colours_.of_vertex[v] && potential.is_free(other))
            together += std::abs(term.weights[j]);
        }
        items_.push_back({t, weight, std::abs(weight) / together});
      }
    first_.push_back(std::ssize(items_));
  }
}

void VertexContacts::add(std::span<const Vec3> x, Index i, VertexDerivatives& sum, std::vector<Placed>& placed) const {
  placed.clear();
  for (std::int64_t n = first_[i]; n < first_[i + 1]; ++n) {
    const auto& [number, weight, share] = items_[n];
    const OffsetTerm& term = terms_[number];
    const Vec3 u = term.offset(x);
    placed.push_back({&term, u, term.normal.dot(u) - term.target, weight / share, share});
    // Most pairs that are near do not touch.
    if (!term.is_spring() && placed.back().gap >= 0 && !(term.friction_force > 0)) continue;
    const OffsetTerm::Derivatives own = term.derivatives(u);
    sum.gradient += weight * own.gradient;
    sum.hessian += weight * weight / share * own.hessian;
  }
}

double VertexContacts::energy(std::span<const Placed> placed, const Vec3& move) {
  double sum = 0;
  for (const auto& [term, offset, gap, scale, share] : placed) {
    if (term->is_spring() || term->friction_force > 0) {
      sum += share * term->energy(offset + scale * move);
    } else {
      sum += share * term->energy_at(std::max(-gap - scale * term->normal.dot(move), 0.0));
    }
  }
  return sum;
}

}  // namespace selvage
