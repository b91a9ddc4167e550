// Numbers with twice a double's digits, for the few pairs that double cannot tell apart.
//
// Dekker, "A floating-point technique for extending the available precision" (1971); Joldes,
// Muller, Popescu, "Tight and rigorous error bounds for basic building blocks of double-word
// arithmetic" (2017), algorithms 6, 12 and 17: relative errors at most 3, 5 and 15 units of 2^-106
// each. The same on all machines, which long double is not.
#pragma once

#include <cmath>
#include <limits>

#include <Eigen/Core>

namespace collision_pairs {

/// The unevaluated sum of two doubles, `lo` at most half a unit in the last place of `hi`. A
/// product or quotient keeps its digits if it is beyond 1e-290. Cost: some 20 operations each.
class DoubleDouble {
 public:
  DoubleDouble() = default;
  DoubleDouble(double value) : hi_(value) {}  // NOLINT: implicit, as between built-in numbers
  explicit operator double() const { return hi_; }

  DoubleDouble operator-() const { return {-hi_, -lo_}; }

  friend DoubleDouble operator+(const DoubleDouble& x, const DoubleDouble& y) {
    const DoubleDouble high = sum(x.hi_, y.hi_), low = sum(x.lo_, y.lo_);
    const DoubleDouble nearly = quickSum(high.hi_, high.lo_ + low.hi_);
    return quickSum(nearly.hi_, low.lo_ + nearly.lo_);
  }
  friend DoubleDouble operator-(const DoubleDouble& x, const DoubleDouble& y) { return x + -y; }
  friend DoubleDouble operator*(const DoubleDouble& x, const DoubleDouble& y) {
    const DoubleDouble high = product(x.hi_, y.hi_);
    const double across = std::fma(x.hi_, y.lo_, std::fma(x.lo_, y.hi_, x.lo_ * y.lo_));
    return quickSum(high.hi_, high.lo_ + across);
  }
  friend DoubleDouble operator/(const DoubleDouble& x, const DoubleDouble& y) {
    const double nearly = x.hi_ / y.hi_;
    if (!std::isfinite(nearly) || nearly == 0.0) return nearly;
    const DoubleDouble rest = x - y * DoubleDouble(nearly);
    return quickSum(nearly, rest.hi_ / y.hi_);
  }
  DoubleDouble& operator+=(const DoubleDouble& other) { return *this = *this + other; }
  DoubleDouble& operator-=(const DoubleDouble& other) { return *this = *this - other; }
  DoubleDouble& operator*=(const DoubleDouble& other) { return *this = *this * other; }
  DoubleDouble& operator/=(const DoubleDouble& other) { return *this = *this / other; }

  friend bool operator==(const DoubleDouble& x, const DoubleDouble& y) {
    return x.hi_ == y.hi_ && x.lo_ == y.lo_;
  }
  friend bool operator<(const DoubleDouble& x, const DoubleDouble& y) {
    return x.hi_ < y.hi_ || (x.hi_ == y.hi_ && x.lo_ < y.lo_);
  }
  friend bool operator<=(const DoubleDouble& x, const DoubleDouble& y) {
    return x.hi_ < y.hi_ || (x.hi_ == y.hi_ && x.lo_ <= y.lo_);
  }
  friend bool operator!=(const DoubleDouble& x, const DoubleDouble& y) { return !(x == y); }
  friend bool operator>(const DoubleDouble& x, const DoubleDouble& y) { return y < x; }
  friend bool operator>=(const DoubleDouble& x, const DoubleDouble& y) { return y <= x; }

  friend DoubleDouble abs(const DoubleDouble& x) { return x.hi_ < 0.0 ? -x : x; }
  friend DoubleDouble sqrt(const DoubleDouble& x) {
    const double nearly = std::sqrt(x.hi_);
    if (!std::isfinite(nearly) || nearly == 0.0) return nearly;
    const DoubleDouble rest = x - product(nearly, nearly);
    return quickSum(nearly, rest.hi_ / (2.0 * nearly));
  }
  friend bool isfinite(const DoubleDouble& x) { return std::isfinite(x.hi_); }

 private:
  DoubleDouble(double hi, double lo) : hi_(hi), lo_(lo) {}

  // Knuth's sum of any two, and Dekker's of two of which the first is the larger one; exact. An
  // infinite sum has no rest.
  static DoubleDouble sum(double x, double y) {
    const double s = x + y, from_y = s - x;
    const double rest = (x - (s - from_y)) + (y - from_y);
    return {s, std::isfinite(s) ? rest : 0.0};
  }
  static DoubleDouble quickSum(double x, double y) {
    const double s = x + y;
    return {s, std::isfinite(s) ? y - (s - x) : 0.0};
  }
  static DoubleDouble product(double x, double y) {
    const double p = x * y;
    return {p, std::isfinite(p) ? std::fma(x, y, -p) : 0.0};
  }

  double hi_ = 0.0, lo_ = 0.0;
};

}  // namespace collision_pairs

/// Of what the algorithms ask; the epsilon is that of the worst operation, rounded up.
template <>
struct std::numeric_limits<collision_pairs::DoubleDouble> : std::numeric_limits<double> {
  static collision_pairs::DoubleDouble epsilon() { return 0x1p-102; }
  static collision_pairs::DoubleDouble infinity() {
    return std::numeric_limits<double>::infinity();
  }
};

template <>
struct Eigen::NumTraits<collision_pairs::DoubleDouble>
    : Eigen::GenericNumTraits<collision_pairs::DoubleDouble> {
  using Real = collision_pairs::DoubleDouble;
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 1 };
  enum { ReadCost = 2, AddCost = 20, MulCost = 10 };
  static Real dummy_precision() { return 1e-24; }
};
