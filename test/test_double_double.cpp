// Numbers of twice a double's digits beside numbers of a hundred: the errors that their header
// promises.
#include <cmath>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <gtest/gtest.h>

#include "double_double.h"
#include "random_inputs.h"

namespace collision_pairs::test_double_double {

using Exact = boost::multiprecision::cpp_bin_float_100;

const Exact UNIT = ldexp(Exact(1), -106);

Exact exactOf(const DoubleDouble& x) {
  const auto high = static_cast<double>(x);
  return Exact(high) + Exact(static_cast<double>(x - DoubleDouble(high)));  // nothing is rounded
}

/// Of any size, with digits in both halves; sometimes without, or the negative of what is nearly
/// it.
DoubleDouble randomNumber(RandomInputs& random, const DoubleDouble& other) {
  const double high = std::ldexp(random.uniform(-1.0, 1.0), random.integer(-60, 60));
  const int kind = random.integer(0, 5);
  if (kind == 0) return high;
  if (kind == 1) return -other + DoubleDouble(std::ldexp(high, -80));
  return DoubleDouble(high) + DoubleDouble(std::ldexp(random.uniform(-1.0, 1.0), -53) * high);
}

/// In units of 2^-106 of the right value.
double errorOf(const DoubleDouble& found, const Exact& right) {
  if (right == 0) return exactOf(found) == 0 ? 0.0 : INFINITY;
  return static_cast<double>(abs(exactOf(found) - right) / (abs(right) * UNIT));
}

TEST(DoubleDouble, HasTheErrorsThatItPromisesAlsoInPlace) {
  RandomInputs random;
  DoubleDouble last = 1.0;
  for (int i = 0; i < 100000; ++i) {
    const DoubleDouble x = randomNumber(random, last), y = randomNumber(random, x);
    const Exact exact_x = exactOf(x), exact_y = exactOf(y);
    if (exact_x == 0 || exact_y == 0) continue;
    ASSERT_LE(errorOf(x + y, exact_x + exact_y), 3.001) << i;
    ASSERT_LE(errorOf(x - y, exact_x - exact_y), 3.001) << i;
    ASSERT_LE(errorOf(x * y, exact_x * exact_y), 5.0) << i;
    ASSERT_LE(errorOf(x / y, exact_x / exact_y), 15.0) << i;
    ASSERT_LE(errorOf(sqrt(abs(x)), sqrt(abs(exact_x))), 16.0) << i;  // epsilon, of any operation
    DoubleDouble sum = x, difference = x, product = x, quotient = x;
    ASSERT_EQ(sum += y, x + y);
    ASSERT_EQ(difference -= y, x - y);
    ASSERT_EQ(product *= y, x * y);
    ASSERT_EQ(quotient /= y, x / y);
    last = x;
  }
}

TEST(DoubleDouble, ComparesByAllItsDigits) {
  RandomInputs random;
  for (int i = 0; i < 100000; ++i) {
    const DoubleDouble x = randomNumber(random, 1.0);
    const DoubleDouble y =
        i % 3 == 0 ? x : x + DoubleDouble(std::ldexp(static_cast<double>(x), -90 + i % 7));
    const DoubleDouble z = i % 2 == 0 ? y : DoubleDouble(static_cast<double>(y));
    const Exact exact_x = exactOf(x), exact_z = exactOf(z);
    ASSERT_EQ(x == z, exact_x == exact_z) << i;
    ASSERT_EQ(x != z, exact_x != exact_z) << i;
    ASSERT_EQ(x < z, exact_x < exact_z) << i;
    ASSERT_EQ(x <= z, exact_x <= exact_z) << i;
    ASSERT_EQ(x > z, exact_x > exact_z) << i;
    ASSERT_EQ(x >= z, exact_x >= exact_z) << i;
    ASSERT_EQ(exactOf(abs(x)), abs(exact_x)) << i;
    ASSERT_EQ(exactOf(-x), -exact_x) << i;
  }
}

TEST(DoubleDouble, OverflowsToInfinityAndNotToNothing) {
  const DoubleDouble large = 1e300, small = 1e-300, infinite = INFINITY;
  for (const DoubleDouble& found :
       {large * large, large / small, infinite + large, infinite / large, sqrt(infinite)}) {
    EXPECT_EQ(static_cast<double>(found), INFINITY);
    EXPECT_FALSE(isfinite(found));
    EXPECT_LT(large, found);
  }
  EXPECT_EQ(static_cast<double>(large / infinite), 0.0);
  EXPECT_EQ(static_cast<double>(sqrt(DoubleDouble(0.0))), 0.0);
  EXPECT_TRUE(isfinite(large));
}

}  // namespace collision_pairs::test_double_double
