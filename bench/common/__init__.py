# SPDX-License-Identifier: BSD-3-Clause
"""What several of the benchmark scripts use."""
