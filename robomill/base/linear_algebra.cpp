#include "robomill/base/linear_algebra.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace robomill::linear_algebra {

Eigen::MatrixXd inverse(const Eigen::MatrixXd& a) {
  return a.partialPivLu().inverse();
}

Eigen::MatrixXcd inverse(const Eigen::MatrixXcd& a) {
  return a.partialPivLu().inverse();
}

Eigen::VectorXd solve(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::MatrixXd solve(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::MatrixXcd solve(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::VectorXd solve_positive_definite(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.llt().solve(b);
}

Eigen::MatrixXd solve_positive_definite(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.llt().solve(b);
}

Eigen::MatrixXcd solve_hermitian(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) {
  return a.ldlt().solve(b);
}

Cholesky cholesky(const Eigen::MatrixXd& a) {
  const Eigen::LLT<Eigen::MatrixXd> factor(a);
  return {.lower = factor.matrixL(), .positive_definite = factor.info() == Eigen::Success};
}

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& a) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(a, false).eigenvalues();
}

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXcd& a) {
  return Eigen::ComplexEigenSolver<Eigen::MatrixXcd>(a, false).eigenvalues();
}

EigenPairs eigen_pairs(const Eigen::MatrixXd& a) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(a);
  if (solver.info() != Eigen::Success) return {};
  return {.values = solver.eigenvalues(), .vectors = solver.eigenvectors(), .converged = true};
}

EigenPairs eigen_pairs(const Eigen::MatrixXcd& a) {
  const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> solver(a);
  if (solver.info() != Eigen::Success) return {};
  return {.values = solver.eigenvalues(), .vectors = solver.eigenvectors(), .converged = true};
}

SymmetricEigenPairs symmetric_eigen_pairs(const Eigen::MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(a);
  return {.values = solver.eigenvalues(), .vectors = solver.eigenvectors()};
}

ThinSvd thin_svd(const Eigen::MatrixXd& a) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {.u = svd.matrixU(), .v = svd.matrixV(), .values = svd.singularValues()};
}

ComplexThinSvd thin_svd(const Eigen::MatrixXcd& a) {
  const Eigen::JacobiSVD<Eigen::MatrixXcd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {.u = svd.matrixU(), .v = svd.matrixV(), .values = svd.singularValues()};
}

Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.householderQr().solve(b);
}

Eigen::VectorXd least_squares_with_pivots(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

Eigen::MatrixXd least_squares_with_pivots(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

Eigen::VectorXcd least_squares_with_pivots(const Eigen::MatrixXcd& a, const Eigen::VectorXcd& b) {
  return a.colPivHouseholderQr().solve(b);
}

Eigen::MatrixXd qr_triangle(const Eigen::MatrixXd& a) {
  return a.householderQr().matrixQR().topRows(a.cols()).triangularView<Eigen::Upper>();
}

}  // namespace robomill::linear_algebra
