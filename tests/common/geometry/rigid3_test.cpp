// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/rigid3.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

#include "tests/support/matchers.h"
#include "tests/support/sim_world.h"

namespace coslam::rigid3_test {
namespace {

using test::PoseNear;
using test::SimilarityNear;
using test::VectorNear;

class Random {
 public:
  double uniform(double low, double high) { return std::uniform_real_distribution<>(low, high)(random_); }
  Eigen::Vector3d vector(double most) { return {uniform(-most, most), uniform(-most, most), uniform(-most, most)}; }
  Rigid3 pose() { return {so3_exp(vector(1.7)), vector(5)}; }
  Similarity3 similarity() { return {uniform(0.2, 5), so3_exp(vector(1.7)), vector(5)}; }
  Vector6d tangent(double most_rad, double most) {
    Vector6d d;
    d << vector(most_rad), vector(most);
    return d;
  }

 private:
  std::mt19937_64 random_{5};
};

TEST(So3, LogInvertsExpAtAllAngles) {
  Random random;
  for (const double angle : {0.0, 1e-12, 1e-9, 1e-7, 1e-4, 0.1, 1.0, 3.0, std::numbers::pi - 1e-6}) {
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d omega = angle * random.vector(1).normalized();
      const Eigen::Quaterniond q = so3_exp(omega);
      EXPECT_NEAR(q.norm(), 1, 1e-15);
      EXPECT_THAT(so3_log(q), VectorNear(omega, 1e-9 * angle + 1e-16)) << angle;
    }
  }
}

TEST(So3, LogTakesTheShortWay) {
  const Eigen::Quaterniond q = so3_exp({0, 0.5, 0});
  const Eigen::Quaterniond negative(-q.w(), -q.x(), -q.y(), -q.z());  // the same rotation
  EXPECT_THAT(so3_log(negative), VectorNear(Eigen::Vector3d(0, 0.5, 0), 1e-12));
}

TEST(So3, ExpIsTheSeriesOfTheSkewMatrix) {
  const Eigen::Vector3d omega(0.3, -0.2, 0.5);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Identity(), term = sum;
  for (int k = 1; k < 25; ++k) sum += term = term * skew(omega) / k;
  EXPECT_LT((so3_exp(omega).toRotationMatrix() - sum).norm(), 1e-13);
}

TEST(Rigid3, NamesCancel) {
  Random random;
  const Rigid3 c_from_b = random.pose(), b_from_a = random.pose();
  const Eigen::Vector3d in_a = random.vector(3);
  EXPECT_THAT((c_from_b * b_from_a) * in_a, VectorNear(c_from_b * (b_from_a * in_a), 1e-12));
  EXPECT_THAT(b_from_a.inverse() * (b_from_a * in_a), VectorNear(in_a, 1e-12));
  EXPECT_THAT(b_from_a.matrix() * in_a.homogeneous(), VectorNear(b_from_a * in_a, 1e-12));
  EXPECT_THAT(b_from_a * b_from_a.center(), VectorNear(Eigen::Vector3d(0, 0, 0), 1e-12));
}

TEST(Rigid3, LocalInvertsRetract) {
  Random random;
  for (const double size : {1e-10, 1e-5, 0.1, 1.5}) {
    for (int i = 0; i < 20; ++i) {
      const Rigid3 pose = random.pose(), other = random.pose();
      const Vector6d d = random.tangent(size, 2 * size);
      EXPECT_LT((local(pose, retract(pose, d)) - d).norm(), 1e-14 + 1e-9 * size);
      EXPECT_THAT(retract(pose, local(pose, other)), PoseNear(other, 1e-7, 1e-11));
    }
  }
}

TEST(Rigid3, RetractActsOnTheLeftRotationFirst) {
  Random random;
  const Rigid3 pose = random.pose();
  const Vector6d d = random.tangent(0.5, 1);
  const Eigen::Vector3d x = random.vector(3);
  EXPECT_THAT(retract(pose, d) * x, VectorNear(so3_exp(d.head<3>()) * (pose * x) + d.tail<3>(), 1e-12));
}

TEST(Rigid3, InterpolateMeetsBothEndsAndTurnsEvenly) {
  Random random;
  const Rigid3 a = random.pose();
  const Rigid3 b = retract(a, random.tangent(0.6, 0.5));
  EXPECT_THAT(interpolate(a, b, 0), PoseNear(a, 1e-7, 1e-12));
  EXPECT_THAT(interpolate(a, b, 1), PoseNear(b, 1e-7, 1e-12));
  const double whole = a.rotation.angularDistance(b.rotation);
  const Rigid3 part = interpolate(a, b, 0.3);
  EXPECT_NEAR(a.rotation.angularDistance(part.rotation), 0.3 * whole, 1e-9);
  EXPECT_THAT(part.translation, VectorNear((0.7 * a.translation + 0.3 * b.translation).eval(), 1e-12));
}

TEST(Similarity3, Algebra) {
  Random random;
  for (int i = 0; i < 20; ++i) {
    const Similarity3 c_from_b = random.similarity(), b_from_a = random.similarity(), a_from_z = random.similarity();
    const Eigen::Vector3d x = random.vector(3);
    EXPECT_THAT((c_from_b * b_from_a) * x, VectorNear(c_from_b * (b_from_a * x), 1e-10));
    EXPECT_THAT(b_from_a.inverse() * (b_from_a * x), VectorNear(x, 1e-10));
    EXPECT_THAT(b_from_a * b_from_a.inverse(), SimilarityNear(Similarity3(), 1e-7, 1e-10, 1e-12));
    EXPECT_THAT((c_from_b * b_from_a) * a_from_z, SimilarityNear(c_from_b * (b_from_a * a_from_z), 1e-7, 1e-9, 1e-12));
    EXPECT_THAT((c_from_b * b_from_a).inverse(),
                SimilarityNear(b_from_a.inverse() * c_from_b.inverse(), 1e-7, 1e-9, 1e-12));
  }
}

TEST(TransformWorld, KeepsEveryProjection) {
  Random random;
  const CameraModel camera = test::sim_camera();
  for (int i = 0; i < 20; ++i) {
    const Rigid3 cam_from_old = random.pose();
    const Similarity3 new_from_old = random.similarity();
    const Rigid3 cam_from_new = transform_world(cam_from_old, new_from_old);
    const Eigen::Vector3d in_cam(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(1, 10));
    const Eigen::Vector3d in_new = new_from_old * (cam_from_old.inverse() * in_cam);
    EXPECT_THAT(camera.project(cam_from_new * in_new), VectorNear(camera.project(in_cam), 1e-7));
    EXPECT_THAT(cam_from_new.center(), VectorNear(new_from_old * cam_from_old.center(), 1e-9));
  }
}

TEST(TransformWorld, ComposesLikeSimilarities) {
  Random random;
  const Rigid3 pose = random.pose();
  const Similarity3 b_from_a = random.similarity(), c_from_b = random.similarity();
  EXPECT_THAT(transform_world(transform_world(pose, b_from_a), c_from_b),
              PoseNear(transform_world(pose, c_from_b * b_from_a), 1e-7, 1e-9));
  EXPECT_THAT(transform_world(pose, Similarity3()), PoseNear(pose, 1e-7, 1e-12));
}

}  // namespace
}  // namespace coslam::rigid3_test
