// A fill-reducing ordering for matrices of 2x2 blocks, one a vertex.
#pragma once

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

namespace orbis::sphere {

// Approximate minimum degree (Amestoy, Davis and Duff 1996, by Eigen) of the graph of blocks, whose rows stay together:
// a quarter of the entries to order, and of the memory for it, which was the largest of a whole embedding. For
// Eigen::SimplicialLDLT; matrices are symmetric, of even size, and every block is stored in full.
struct BlockOrdering {
  using PermutationType = Eigen::AMDOrdering<int>::PermutationType;

  template <class Matrix> void operator()(const Matrix& matrix, PermutationType& order) const {
    const Eigen::Index blocks = matrix.cols() / 2;
    Eigen::SparseMatrix<signed char, Eigen::ColMajor, int> graph(blocks, blocks); // lower triangle
    graph.reserve(matrix.nonZeros() / 8 + blocks);
    for (Eigen::Index j = 0; j < blocks; ++j) {
      graph.startVec(j);
      for (typename Matrix::InnerIterator entry(matrix, 2 * j); entry; ++entry)
        if (entry.row() % 2 == 0 && entry.row() >= 2 * j) graph.insertBack(entry.row() / 2, j) = 1;
    }
    graph.finalize();
    PermutationType of_blocks;
    Eigen::AMDOrdering<int>()(graph.template selfadjointView<Eigen::Lower>(), of_blocks);
    order.resize(matrix.cols());
    for (Eigen::Index i = 0; i < blocks; ++i)
      for (const int k : {0, 1}) order.indices()[2 * i + k] = 2 * of_blocks.indices()[i] + k;
  }
};

} // namespace orbis::sphere
