// The real spherical harmonics of 3DGS. Their C++ twin is sh_basis in src/splat/gaussians.cpp.

const int kMaxShCoefficients = 16;

// Y₀…Y₁₅ at unit direction d.
void shBasis(vec3 d, out float basis[kMaxShCoefficients]) {
  float x = d.x, y = d.y, z = d.z;
  float xx = x * x, yy = y * y, zz = z * z;
  basis[0] = 0.28209479177387814;
  basis[1] = -0.4886025119029199 * y;
  basis[2] = 0.4886025119029199 * z;
  basis[3] = -0.4886025119029199 * x;
  basis[4] = 1.0925484305920792 * x * y;
  basis[5] = -1.0925484305920792 * y * z;
  basis[6] = 0.31539156525252005 * (2.0 * zz - xx - yy);
  basis[7] = -1.0925484305920792 * x * z;
  basis[8] = 0.5462742152960396 * (xx - yy);
  basis[9] = -0.5900435899266435 * y * (3.0 * xx - yy);
  basis[10] = 2.890611442640554 * x * y * z;
  basis[11] = -0.4570457994644658 * y * (4.0 * zz - xx - yy);
  basis[12] = 0.3731763325901154 * z * (2.0 * zz - 3.0 * xx - 3.0 * yy);
  basis[13] = -0.4570457994644658 * x * (4.0 * zz - xx - yy);
  basis[14] = 1.445305721320277 * z * (xx - yy);
  basis[15] = -0.5900435899266435 * x * (xx - 3.0 * yy);
}
