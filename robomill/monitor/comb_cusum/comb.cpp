#include "robomill/monitor/comb_cusum/comb.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::monitor {

Comb::Comb(std::size_t max_harmonics) : max_(max_harmonics) {
  const std::size_t groups = (max_harmonics + width - 1) / width;
  for (auto* store : {&a_re_, &a_im_, &w_re_, &w_im_, &s_re_, &s_im_, &g_re_, &g_im_}) store->resize(groups);
  reset();
}

void Comb::reset() noexcept {
  for (auto* store : {&a_re_, &a_im_, &w_re_, &w_im_, &s_re_, &s_im_, &g_re_, &g_im_}) {
    std::fill(store->begin(), store->end(), Group{});
  }
}

void Comb::set_harmonics(std::size_t count) noexcept {
  count_ = std::min(count, max_);
  groups_ = (count_ + width - 1) / width;
  for (std::size_t k = count_; k < a_re_.size() * width; ++k) {
    a_re_[k / width].v[k % width] = 0.0F;
    a_im_[k / width].v[k % width] = 0.0F;
  }
}

std::complex<double> Comb::amplitude(std::size_t k) const noexcept {
  const std::size_t at = k - 1;
  return {static_cast<double>(a_re_[at / width].v[at % width]), static_cast<double>(a_im_[at / width].v[at % width])};
}

std::complex<double> Comb::innovation(std::size_t k) const noexcept {
  const std::size_t at = k - 1;
  return {scale_ * static_cast<double>(g_re_[at / width].v[at % width]),
          scale_ * static_cast<double>(g_im_[at / width].v[at % width])};
}

void Comb::correct(std::size_t k, std::complex<double> by) noexcept {
  const std::size_t at = k - 1;
  a_re_[at / width].v[at % width] += static_cast<float>(by.real());
  a_im_[at / width].v[at % width] += static_cast<float>(by.imag());
}

void Comb::run(std::span<const float> x, std::span<float> residual, double angle, double turn, double gain,
               double bound) noexcept {
  const std::complex<double> first = std::polar(1.0, angle);
  const std::complex<double> step = std::polar(1.0, turn);
  std::complex<double> w = first;
  std::complex<double> s = step;
  for (std::size_t k = 0; k < groups_ * width; ++k, w *= first, s *= step) {
    w_re_[k / width].v[k % width] = static_cast<float>(w.real());
    w_im_[k / width].v[k % width] = static_cast<float>(w.imag());
    s_re_[k / width].v[k % width] = static_cast<float>(s.real());
    s_im_[k / width].v[k % width] = static_cast<float>(s.imag());
  }
  for (std::size_t g = 0; g < groups_; ++g) g_re_[g] = g_im_[g] = Group{};
  const auto most = static_cast<float>(bound);
  for (std::size_t t = 0; t < x.size(); ++t) {
    Vector sum{};
    for (std::size_t g = 0; g < groups_; ++g) sum += a_re_[g].v * w_re_[g].v - a_im_[g].v * w_im_[g].v;
    float periodic = 0.0F;
    for (std::size_t lane = 0; lane < width; ++lane) periodic += sum[lane];
    residual[t] = x[t] - periodic;
    const float learnt = std::clamp(residual[t], -most, most);
    for (std::size_t g = 0; g < groups_; ++g) {
      g_re_[g].v += learnt * w_re_[g].v;
      g_im_[g].v -= learnt * w_im_[g].v;
      const Vector next = w_re_[g].v * s_re_[g].v - w_im_[g].v * s_im_[g].v;
      w_im_[g].v = w_re_[g].v * s_im_[g].v + w_im_[g].v * s_re_[g].v;
      w_re_[g].v = next;
    }
  }
  scale_ = x.empty() ? 0.0 : 2.0 / static_cast<double>(x.size());
  const auto weight = static_cast<float>(gain * scale_);
  for (std::size_t g = 0; g < groups_; ++g) {
    a_re_[g].v += weight * g_re_[g].v;
    a_im_[g].v += weight * g_im_[g].v;
  }
  for (std::size_t k = count_; k < groups_ * width; ++k)
    a_re_[k / width].v[k % width] = a_im_[k / width].v[k % width] = 0.0F;
}

}  // namespace robomill::monitor
